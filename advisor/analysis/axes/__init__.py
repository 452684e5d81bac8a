"""From logs to the gap of one axis."""
