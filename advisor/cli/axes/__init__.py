"""``advisor gap`` for pitch, and for roll and yaw."""
