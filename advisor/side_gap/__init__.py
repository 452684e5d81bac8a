"""The gap of roll and yaw: derivatives and effects of the simulator against the flight."""
