"""Inflight advisor: was that manoeuvre good, and may we stop testing."""

__version__ = "0.1.0"
