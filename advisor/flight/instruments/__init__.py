"""Instruments as models, and their properties that the motion alone shows."""
