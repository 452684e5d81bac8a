"""The simulator under diagnosis: the short period with every effect, and the reading of its outputs."""
