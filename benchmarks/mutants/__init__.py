"""Mutants: a seed draws lines that decide, each is changed, and the nearest tests must notice."""
