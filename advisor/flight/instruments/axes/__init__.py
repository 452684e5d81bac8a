"""Examination of the instruments of one axis."""
