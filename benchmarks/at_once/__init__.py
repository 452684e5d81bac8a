"""Inputs of three surfaces at once: derivatives of both axes against the truth."""
