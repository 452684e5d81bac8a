"""Quantiles of the normal distribution, each in one place."""

NORMAL_95 = 1.959963984540054
"""Half-width of an interval that holds 95 % of a normal distribution, in standard deviations."""
