"""Quantiles of the normal distribution that several modules use."""

NORMAL_95 = 1.959963984540054
"""Half-width of an interval that holds 95 % of a normal distribution, in standard deviations."""
PAIR_95 = 2.447746830680816
"""Radius of the region that holds 95 % of a normal distribution of two quantities, in standard deviations:
√(-2·ln 0.05)."""
