"""The outputs of the short period."""

OUTPUTS = ("alpha", "q", "a_z", "theta")
"""Angle of attack (rad), pitch rate (rad/s), specific force along body z (m/s²) and pitch angle (rad)."""
