"""Logs of ArduPilot."""
