"""The campaigns of the axes."""
