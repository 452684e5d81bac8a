"""Check of telemetry before a flight: whether the telemetry suffices to identify a short period, and which
settings to change.
"""
