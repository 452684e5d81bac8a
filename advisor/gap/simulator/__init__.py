"""Simulator under diagnosis: the short period with every effect, and its measured outputs."""
