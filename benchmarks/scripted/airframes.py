"""Airframes of ArduPlane's simulator that fly the script: the light plane, and five that nobody tuned."""

from collections.abc import Callable, Mapping

from .pilot import Airframe, light

_STIFF = {
    "c_lift_0": 0.42, "c_lift_a": 5.8, "c_drag_p": 0.07, "c_m_0": 0.05, "c_m_a": -1.3, "c_m_q": -15.0,
    "c_m_deltae": 1.0, "c_l_p": -0.8, "c_l_r": 0.1, "c_l_deltaa": 0.21, "c_l_b": -0.07, "c_n_b": 0.09,
    "c_n_r": -0.35, "c_n_p": -0.03, "c_n_deltar": 0.06, "c_n_deltaa": -0.01, "c_y_b": -0.8,
    "CGOffset_x": 0.0, "CGOffset_z": 0.0,
}  # fmt: skip
"""A stiff plane of drawn numbers."""


def stiff() -> Airframe:
    """Return a stiff plane with narrow servos whose middle is off 1500 us, and softer gains in pitch."""
    return Airframe(
        _STIFF,
        {
            "PTCH_RATE_FF": 0.35, "PTCH_RATE_P": 0.08, "PTCH_RATE_D": 0.003, "PTCH_RATE_I": 0.08,
            "SERVO1_MIN": 1050, "SERVO1_TRIM": 1490, "SERVO1_MAX": 1950,
            "SERVO2_MIN": 1150, "SERVO2_TRIM": 1520, "SERVO2_MAX": 1870,
            "SERVO4_MIN": 1080, "SERVO4_TRIM": 1480, "SERVO4_MAX": 1900,
        },
    )  # fmt: skip


def turned() -> Airframe:
    """Return the light plane with reversed elevator and rudder, in the linkage and in the autopilot."""
    turned = {name: -value for name, value in light().coefficients.items() if name in _OF_TURNED}
    return Airframe(
        {**light().coefficients, **turned, "c_l_deltar": 0.037, "c_y_deltar": 0.2},
        {"SERVO2_REVERSED": 1, "SERVO4_REVERSED": 1, "SERVO2_TRIM": 1510, "SERVO4_TRIM": 1495},
    )


_OF_TURNED = ("c_m_deltae", "c_n_deltar")


def v_tail() -> Airframe:
    """Return the light plane with a V-tail."""
    return Airframe(
        light().coefficients,
        {"SERVO2_FUNCTION": 79, "SERVO2_REVERSED": 1, "SERVO4_FUNCTION": 80},
        "plane-vtail",
    )


def elevons() -> Airframe:
    """Return the light plane with elevons and without a rudder."""
    return Airframe(
        light().coefficients,
        {
            "SERVO1_FUNCTION": 78, "SERVO1_REVERSED": 1, "SERVO2_FUNCTION": 77, "SERVO2_REVERSED": 1,
            "SERVO4_FUNCTION": 0,
        },
        "plane-elevon",
    )  # fmt: skip


def flaperons() -> Airframe:
    """Return the light plane with flaperons, of which the simulator moves the left one."""
    return Airframe(light().coefficients, {"SERVO1_FUNCTION": 24, "SERVO5_FUNCTION": 25})


AIRFRAMES: Mapping[str, Callable[[], Airframe]] = {
    "light": light, "stiff": stiff, "turned": turned, "v-tail": v_tail, "elevons": elevons,
    "flaperons": flaperons,
}  # fmt: skip
