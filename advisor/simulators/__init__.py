"""Simulators for a comparison with a flight: a small protocol, and adapters to programs."""
