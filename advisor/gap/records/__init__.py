"""Manoeuvres made ready for the comparison: what was measured, by what, and how well."""
