"""Is this telemetry good enough to identify a short period, and what to change if not."""
