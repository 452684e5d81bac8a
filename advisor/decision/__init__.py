"""Decisions: whether a manoeuvre is good, whether the test may stop, and which input to fly next."""
