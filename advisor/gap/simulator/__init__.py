"""The simulator under diagnosis: the short period with every effect in it, and how its outputs are read."""
