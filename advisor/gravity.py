"""Standard gravity, of which every specific force is reckoned."""

GRAVITY_M_S2 = 9.80665
"""3rd CGPM, 1901."""
