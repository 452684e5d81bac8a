"""Order of the short period's outputs and parameters."""

OUTPUTS = ("alpha", "q", "a_z", "theta")
"""Angle of attack (rad), pitch rate (rad/s), specific force along body z (m/s²) and pitch angle (rad)."""
SHARED = ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e", "airspeed_scale")
"""Parameters that all manoeuvres share."""
LOCAL = ("Z_0", "M_0", "alpha_initial", "q_initial", "theta_initial", "q_bias", "a_z_bias")
"""Parameters with a separate value for each manoeuvre."""
N_SHARED, N_LOCAL = len(SHARED), len(LOCAL)
N_PARAMETERS = N_SHARED + N_LOCAL
N_MOVING = N_SHARED + 4
"""Number of parameters that affect α and q; the other parameters only affect the outputs."""
