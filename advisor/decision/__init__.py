"""Decisions: acceptance of a manoeuvre, end of the flight test, and the next input."""
