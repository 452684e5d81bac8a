"""Simulators that a flight is compared with: a small protocol, and adapters to real programs."""
