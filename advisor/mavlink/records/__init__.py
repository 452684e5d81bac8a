"""Records of an autopilot's own log, and the equivalent messages."""
