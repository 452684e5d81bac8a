"""Improvement of a simulator from a diagnosis, in the formats of other programs."""
