"""Sealed flights of both axes: rigid bodies in gusts, flown by hand between the inputs of one control."""
