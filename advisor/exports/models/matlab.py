"""A script for MATLAB and Octave: A, B, C, D about the trim, and the eight parameters with their intervals.

    x = [α; q],  u = δe,  y = [α; q; a_z],  all departures from trim

With N = α̇ - q, the specific force along body z at the centre of gravity is V·N to first order. Its rows are
V times (Z_α, Z_q) and V·Z_δe.
"""

from advisor.aircraft.reference import PARAMETERS
from advisor.exports.models.exported import Exported, commented, effects_beside
from advisor.exports.models.improvement import Improvement

UNITS = {
    "Z_0": "rad/s", "Z_alpha": "1/s", "Z_q": "1", "Z_delta_e": "1/s",
    "M_0": "rad/s^2", "M_alpha": "1/s^2", "M_q": "1/s", "M_delta_e": "1/s^2",
}  # fmt: skip


def script_text(improvement: Improvement) -> Exported:
    """Return the script. The script needs no toolbox, and leaves its variables in the workspace."""
    m = {name: improvement.number(name) for name in PARAMETERS}
    speed, servo = improvement.true_airspeed_m_s, improvement.servo
    head = commented(
        [
            f"{improvement.name}: short period found by the inflight advisor.",
            "State x = [alpha; q] (rad, rad/s), input u = delta_e (rad, trailing edge down positive),",
            "output y = [alpha; q; a_z] (rad, rad/s, m/s^2; body z is down): departures from trim.",
            "xdot = A*x + B*u, y = C*x + D*u, where u has passed the servo below.",
            improvement.air_note,
        ],
        "%",
    )
    matrices = [
        f"V = {speed:.8g};  % true air speed of the derivatives, m/s",
        f"A = [{m['Z_alpha']:.8g}, {1.0 + m['Z_q']:.8g}; {m['M_alpha']:.8g}, {m['M_q']:.8g}];",
        f"B = [{m['Z_delta_e']:.8g}; {m['M_delta_e']:.8g}];",
        f"C = [1, 0; 0, 1; V*({m['Z_alpha']:.8g}), V*({m['Z_q']:.8g})];",
        f"D = [0; 0; V*({m['Z_delta_e']:.8g})];",
        "% Each parameter: value, and the ends of its 95 % interval.",
    ]
    for name in PARAMETERS:
        low, high = improvement.interval95(name)
        matrices += [
            f"parameters.{name}.value = {improvement.model[name].value:.8g};  % {UNITS[name]}",
            f"parameters.{name}.ci95 = [{low:.8g}, {high:.8g}];",
        ]
    rate = f"{servo.rate_rad_s:.6g}" if servo.rate_rad_s else "Inf"
    between = [
        "% Between command and surface: delay, then lag, then what limits the surface.",
        f"servo.delay_s = {servo.delay_s:.6g};  % s",
        f"servo.lag_s = {servo.lag_s:.6g};  % s, by which the surface trails a ramp",
        f"servo.damping = {servo.damping or 0.0:.6g};  % 0: a lag of first order, 1/(lag_s*s + 1)",
        f"servo.rate_limit_rad_s = {rate};  % rad/s",
        f"servo.backlash_rad = {servo.play_rad:.6g};  % rad, whole width",
        f"servo.deadband_rad = {servo.deadband_rad:.6g};  % rad, whole width",
        f"servo.deadband_neutral_rad = {servo.neutral_rad:.6g};  % rad, its middle",
    ]
    left = (*effects_beside(improvement), *improvement.untold)
    return Exported(head + "\n".join([*matrices, *between]) + "\n", left)
