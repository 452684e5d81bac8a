"""Diagnosis of the gap along any axis, which callers hand in: no module of this room imports a table."""
