"""Manoeuvres prepared for the comparison: measured channels, their instruments and their noise."""
