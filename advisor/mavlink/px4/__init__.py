"""Logs of PX4."""
