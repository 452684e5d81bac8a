"""Statements of the crew about its aircraft, as data classes."""
