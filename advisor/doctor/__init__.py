"""Check of telemetry before a flight: whether it suffices to identify a short period, and which settings to
change."""
