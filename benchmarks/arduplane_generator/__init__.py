"""Sealed flights of ArduPlane in its own simulator, with drawn coefficients: the motion is nobody's here."""
