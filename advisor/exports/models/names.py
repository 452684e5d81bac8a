"""Names of the formats of a model, for options and messages, without the formats themselves."""

NAMES = ("jsbsim", "ardupilot", "sdf", "matlab", "aircraft")
