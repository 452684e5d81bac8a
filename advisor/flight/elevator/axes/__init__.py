"""The control surfaces of one axis in the outputs of an autopilot."""
