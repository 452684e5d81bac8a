"""Estimation along any axis, which callers hand in: no module of this room imports the table of an axis."""
