"""Sealed cases: flights whose effect is withheld, and the score of a diagnosis of them."""
