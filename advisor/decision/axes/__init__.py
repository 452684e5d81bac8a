"""Demands of each axis of the aircraft on a manoeuvre, as data and formulas of its own motion."""
