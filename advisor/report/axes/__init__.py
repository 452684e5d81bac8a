"""Documents and texts of one axis."""
