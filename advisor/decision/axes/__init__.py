"""What each axis of the aircraft asks of a manoeuvre, as data and formulas of its own motion."""
