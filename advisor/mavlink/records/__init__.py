"""Records of an autopilot's own log, and the messages that they are equal to."""
