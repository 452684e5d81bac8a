"""Flights that are diagnosed again after a change that every telemetry has, so that no truth is needed."""
