"""Sealed cases: flights whose effect is withheld, and the score of their diagnosis."""
