"""Names of the model export formats for options and messages, without imports of the formats."""

NAMES = ("jsbsim", "ardupilot", "matlab", "aircraft")
