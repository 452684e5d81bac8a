"""Faces without a screen: text, JSON, pictures."""
