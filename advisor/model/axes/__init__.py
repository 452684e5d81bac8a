"""Models of the axes, as tables of terms."""
