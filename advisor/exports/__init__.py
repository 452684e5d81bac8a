"""Data and models for other programs."""
