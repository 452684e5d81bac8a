"""Manoeuvres prepared for the comparison: which channels were measured, by which instrument, and how well."""
