"""Names of the formats in which a model is exported, for options and messages, without importing the
formats."""

NAMES = ("jsbsim", "ardupilot", "sdf", "matlab", "aircraft")
