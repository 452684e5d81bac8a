"""Sections of a page about one axis."""
