"""``advisor gap`` on each axis."""
