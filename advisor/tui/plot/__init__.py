"""Plots in a terminal: braille dots, axes with units, one widget."""
