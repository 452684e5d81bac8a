"""Standard gravity, which converts g into m/s²."""

GRAVITY_M_S2 = 9.80665
"""Standard acceleration of gravity, m/s² (3rd General Conference on Weights and Measures, 1901)."""
