"""Models of the axes, as tables of parameters."""
