"""Sealed cases of the bundled aircraft: flights whose effect is withheld."""
