"""The pitch axis: angle of attack α and pitch rate q, by the elevator.

    α̇ = s·(Z_α·α + Z_δe·δe + Z_0) + (1 + Z_q)·q + (g/V)·(cos α·cos θ·cos φ + sin α·sin θ) + slip
    q̇ = s²·(M_α·α + M_δe·δe + M_0) + s·M_q·q + M_steady + (I_zz - I_xx)/I_yy·p·r

θ, φ, V and the turn of α by rolling in sideslip are known signals. M_steady is a part of the moment in trim
that does not grow with the air speed, such as the thrust's. Outputs are q, a_z = V·(the parameters' part of
α̇) and α - (x_α/V)·q. The attitude is no output, because it integrates every error of the pitch rate.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.aircraft.reference import SPEED_EXPONENTS
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.model.axis import (
    CONSTANT,
    Around,
    Axis,
    Change,
    Curve,
    Known,
    Moment,
    Prior,
    Read,
    Reported,
    Term,
)
from advisor.process.arrays import FloatArray

NAMES = ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e", "M_steady")
AIR_SPEED_STD = 0.05
"""Prior standard deviation of the relative excess of the true over the read air speed, as data sheets state
it. The read speed may be an indicated one."""
Z_Q_STD = 0.1
"""Prior standard deviation of Z_q, without unit. C_Lq of 10 gives 0.03 to 0.1 for aircraft of 3 kg to 8 t."""
LIFT_OVER_MOMENT_S = 0.02
"""Prior standard deviation of Z_δe/M_δe, s. Published estimates give 0.008 (twin jet) and 0.010 (twin
turboprop)."""
STEADY = 0.05
"""Prior standard deviation of M_steady, over the moment of a radian of elevator."""
INERTIA = 0.5, 0.29
"""Mean and standard deviation of the prior of (I_zz - I_xx)/I_yy, which lies between zero and one."""
DAMPING = 0.05
"""Damping of an oscillator in structure or fuel, without unit."""
BENT = 0.5
"""Prior standard deviation of a nonlinear term at the largest flown deviation, over the linear term."""
_FACTORS = {"alpha": "alpha", "q": "q", "delta_e": "elevator", "steady": CONSTANT}
_STATES = {"Z": "alpha", "M": "q"}
_AIR, _VANE, _SEAT = ("airspeed", "excess"), ("alpha", "arm_m"), ("a_z", "arm_m")


def _term(name: str) -> Term:
    return Term(name, _STATES[name[0]], _FACTORS[name[2:]], SPEED_EXPONENTS.get(name, 0))


def natural_size(theta: FloatArray) -> Mapping[str, float]:
    """Return the typical size of each derivative on an aircraft with these derivatives (7,)."""
    value = dict(zip(NAMES, np.abs(theta).tolist(), strict=True))
    lift = max(value["Z_alpha"], 0.1)
    stiff, power = max(value["M_alpha"], 0.1 * value["M_delta_e"], 0.1), value["M_delta_e"]
    return {
        "Z_alpha": lift, "Z_q": 1.0, "Z_delta_e": max(value["Z_delta_e"], 0.3 * lift), "M_alpha": stiff,
        "M_q": max(value["M_q"], 0.3 * np.sqrt(stiff)), "M_delta_e": max(power, 0.3 * stiff, 0.1),
        "M_steady": STEADY * max(power, 0.1),
    }  # fmt: skip


def priors(theta: FloatArray, _: Sequence[str], tells_force: bool, airspeed_m_s: float) -> Prior:
    """Return the priors for derivatives near ``theta`` (7,).

    The tail's lift turns the path by its force and the nose by its moment, so Z_δe is a small part of M_δe.
    """
    std = {**dict.fromkeys(NAMES, np.inf), "Z_q": Z_Q_STD}
    size = natural_size(theta)
    std |= {"M_steady": max(size["M_steady"], 1e-3), "Z_delta_e": LIFT_OVER_MOMENT_S * size["M_delta_e"]}
    mean = dict.fromkeys(NAMES, 0.0)
    if not tells_force:
        # The lift of level flight at a usual angle of attack of 0.1 rad.
        mean["Z_alpha"] = -GRAVITY_M_S2 / (0.1 * airspeed_m_s)
        std["Z_alpha"] = -mean["Z_alpha"]
    return Prior(np.array(list(mean.values())), np.array(list(std.values())))


def qualities(theta: FloatArray, around: Around) -> tuple[Mapping[str, Reported], Mapping[str, str]]:
    """Return frequency and damping of the short period, whose characteristic equation is
    λ² - (Z_α + M_q)·λ + Z_α·M_q - (1 + Z_q)·M_α = 0."""
    z_alpha, z_q, _, m_alpha, m_q, *_ = theta.tolist()
    square = z_alpha * m_q - (1.0 + z_q) * m_alpha
    if square <= 0.0:
        return {}, {"short_period": "the aircraft has no short-period oscillation at these values"}
    slope = np.zeros((2, len(NAMES)))
    slope[0, [0, 1, 3, 4]] = m_q, -m_alpha, -(1.0 + z_q), z_alpha
    slope[1, [0, 4]] = 1.0
    omega = float(np.sqrt(square))
    zeta = -(z_alpha + m_q) / (2.0 * omega)
    by_omega = slope[0] / (2.0 * omega)
    return {
        "short_period_omega": Reported(omega, by_omega),
        "short_period_zeta": Reported(zeta, -slope[1] / (2.0 * omega) - zeta / omega * by_omega),
    }, {}


def _equal(*names: str) -> Mapping[str, float]:
    return dict.fromkeys(names, 1.0)


def _arms(theta: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
    """Return the change of all moments by a moved centre of gravity, relative to that of M_α.

    Every force gets the same further arm.
    """
    arm = theta["M_alpha"] / theta["Z_alpha"]
    pairs = (("Z_alpha", "M_alpha"), ("Z_q", "M_q"), ("Z_delta_e", "M_delta_e"))
    return ({moment: arm * theta[force] / theta[moment] for force, moment in pairs},)


_ICED = ("Z_alpha", "Z_delta_e", "M_alpha", "M_delta_e")
_FREE = ((-0.9, 3.0),)
CHANGES = {
    "mass": Change("mass_change", ("step",), lambda _: (_equal(*NAMES),), 0.15, _FREE, divides=True),
    "stability": Change(
        "cg_shift", ("step",), lambda _: (_equal("M_alpha"),), 0.2, _FREE, fixed={"stability_only": 1.0}
    ),
    "arms": Change("cg_shift", ("step",), _arms, 0.2, _FREE),
    "ice": Change(
        "icing", _ICED, lambda _: [_equal(name) for name in _ICED], 0.15,
        ((-0.9, 0.02), (-0.9, 0.3), (-0.9, 0.3), (-0.9, 0.02)),
    ),
    "power": Change(
        "elevator_loss", ("step",), lambda _: (_equal("Z_delta_e", "M_delta_e"),), 0.5, ((-0.9, 2.0),),
        has_name=False,
    ),
}  # fmt: skip
_F, _M, _GYRO, _SEAT_BLOCK, _ANGLE = (
    "force_equation", "moment_equation", "pitch_rate_sensor", "accelerometer", "alpha_sensor",
)  # fmt: skip


Motion = Mapping[str, FloatArray]
"""States, inputs, readings and rates relative to trim, and the time, each at equal time steps."""
Sizes = Mapping[str, float]


def _lagged(y: FloatArray, t: FloatArray, lag_s: float) -> FloatArray:
    """Return a signal behind a first-order lag."""
    from scipy.signal import lfilter  # not on the start path

    kept = float(np.exp(-(t[1] - t[0]) / lag_s))
    return np.asarray(lfilter([1.0 - kept], [1.0, -kept], y))


def _swinging(y: FloatArray, t: FloatArray, hz: float) -> FloatArray:
    """Return the response of an oscillator with unit stiffness, by equal steps of its recursion."""
    from scipy.signal import lfilter  # not on the start path

    step, omega = float(t[1] - t[0]), 2.0 * np.pi * hz
    kept, turn = np.exp(-DAMPING * omega * step), omega * step * np.sqrt(1.0 - DAMPING**2)
    back = np.array([1.0, -2.0 * kept * np.cos(turn), kept**2])
    return np.asarray(lfilter([np.sum(back)], back, y))


def _bent(effect: str, block: str, names: tuple[str, str], of: str, slope: str) -> Curve:
    """Return square and cube of a quantity, with widths from the linear term ``slope``."""

    def std(size: Sizes, most: Sizes) -> Sequence[float]:
        return BENT * size[slope] / most[of], BENT * size[slope] / most[of] ** 2

    return Curve(effect, block, names, lambda x, _: (x[of] ** 2, x[of] ** 3), std)


def _of_reading(effect: str, block: str) -> Curve:
    """Return square and cube of a reading as its error."""

    def std(_: Sizes, most: Sizes) -> Sequence[float]:
        return BENT / most[block], BENT / most[block] ** 2

    names = ("square", "cube")
    return Curve(effect, block, names, lambda x, _: (x[block] ** 2, x[block] ** 3), std, has_name=False)


def _of_turning(effect: str, block: str, names: tuple[str, str], slope: str) -> Curve:
    """Return |q| and q·|q|, with widths from the linear term ``slope``."""

    def std(size: Sizes, most: Sizes) -> Sequence[float]:
        return BENT * size[slope], BENT * size[slope] / most["q"]

    def forms(x: Motion, _: Sizes) -> Sequence[FloatArray]:
        return np.abs(x["q"]), np.abs(x["q"]) * x["q"]

    return Curve(effect, block, names, forms, std, has_name=False)


def _unsteady(lag_s: float) -> Curve:
    """Return the lift that builds up behind a lag."""

    def forms(x: Motion, size: Sizes) -> Sequence[FloatArray]:
        return (size["Z_alpha"] * (x["alpha"] - _lagged(x["alpha"], x["t"], lag_s)),)

    return Curve("unsteady_lift", _F, ("share",), forms, lambda *_: (0.3,), {"lag_s": lag_s})


def _oscillator(
    effect: str, block: str, names: tuple[str, str], std: tuple[float, float], hz: float, has_name: bool
) -> Curve:
    """Return an oscillator that the pitch rate and its rate drive."""

    def forms(x: Motion, _: Sizes) -> Sequence[FloatArray]:
        return [_swinging(x[name], x["t"], hz) for name in ("q", "q'")]

    fixed = {"frequency_hz": hz, "damping": DAMPING}
    return Curve(effect, block, names, forms, lambda *_: std, fixed, has_name)


def _crossed(x: Motion, _: Sizes) -> Sequence[FloatArray]:
    return x["alpha"] * x["q"], x["alpha"] * x["elevator"]


def _crossed_std(size: Sizes, most: Sizes) -> Sequence[float]:
    return [BENT * size[name] / most["alpha"] for name in ("M_q", "M_delta_e")]


CURVES = (
    _bent("nonlinear_lift", _F, ("Z_alpha2", "Z_alpha3"), "alpha", "Z_alpha"),
    _bent("nonlinear_pitching_moment", _M, ("M_alpha2", "M_alpha3"), "alpha", "M_alpha"),
    _bent("elevator_nonlinearity", _M, ("M_delta2", "M_delta3"), "elevator", "M_delta_e"),
    Curve("alpha_dot", _M, ("M_alpha_dot",), lambda x, _: (x["alpha'"],), lambda *_: (1.5,)),
    *map(_unsteady, (0.1, 0.3, 0.8)),
    *(
        _oscillator("structural_mode", _GYRO, ("displacement_gain", "gain"), (1.0, 0.3), hz, True)
        for hz in (2.5, 4.0, 6.0, 8.5)
    ),
    _of_turning("damping_curve", _M, ("M_q_abs", "M_q_q"), "M_q"),
    _of_turning("lift_of_turning", _F, ("Z_q_abs", "Z_q_q"), "Z_q"),
    Curve(
        "crossed_moment", _M, ("M_alpha_q", "M_alpha_delta_e"), _crossed, _crossed_std, has_name=False
    ),
    _of_reading("accelerometer_curve", _SEAT_BLOCK),
    _of_reading("alpha_curve", _ANGLE),
    Curve(
        "gyro_pulled", _GYRO, ("per_m_s2",), lambda x, _: (x[_SEAT_BLOCK],), lambda *_: (0.05,),
        has_name=False,
    ),
    *(
        _oscillator("oscillator", _M, ("gain", "gain_rate"), (3.0, 0.5), hz, False)
        for hz in (1.0, 1.6, 2.5, 4.0)
    ),
)  # fmt: skip

PITCH = Axis(
    key="pitch",
    name="pitch",
    states=("alpha", "q"),
    inputs=("elevator",),
    outputs=("alpha", "q", "a_z"),
    shared=tuple(map(_term, NAMES)),
    constants=(Term("Z_0", "alpha", CONSTANT, 1), Term("M_0", "q", CONSTANT, 2)),
    biases=("a_z",),
    factors={
        "weight": lambda x: GRAVITY_M_S2 / x["airspeed"] * (
            np.cos(x["alpha"]) * np.cos(x["theta"]) * np.cos(x["bank"])
            + np.sin(x["alpha"]) * np.sin(x["theta"])
        ),
        "slip": lambda x: x["slip"],
        "-vane": lambda x: -x[_VANE] / x["airspeed"],
        "-1/V": lambda x: -1.0 / x["airspeed"],
        "V": lambda x: x["airspeed"],
        "-seat": lambda x: -x[_SEAT],
    },
    turning=(
        Known("alpha", "q", CONSTANT), Known("alpha", CONSTANT, "weight"), Known("alpha", CONSTANT, "slip"),
        Known("alpha", CONSTANT, "weight", _AIR, -1.0),
    ),
    seen=(
        Read("alpha", "alpha"), Read("alpha", "q", "-vane"), Read("q", "q"),
        Read("a_z", "alpha", "V", of_rate=True), Read("a_z", "q", "-seat", of_rate=True),
        Read("alpha", "q", "-vane", False, _AIR, -1.0), Read("a_z", "alpha", "V", True, _AIR),
        Read("alpha", "q", "-1/V", False, _VANE),
    ),
    open=(_AIR,),
    instruments=(_AIR, _VANE, _SEAT),
    needed=("q",),
    given=("airspeed", "alpha", "theta", "bank", "slip"),
    optional=("theta", "bank", "slip"),
    body="a_x",
    floor={"alpha": 5e-4, "q": 5e-4, "a_z": 0.02},
    letters=_STATES,
    spoken={"alpha": "alpha", "q": "q"},
    hidden="alpha",
    force="a_z",
    clocks=("alpha",),
    arms=("alpha",),
    errors={_AIR: AIR_SPEED_STD},
    moments={
        ("inertia", "share"): Moment("q", ("p", "r"), *INERTIA),
        ("throttle", "M_throttle"): Moment("q", ("throttle",)),
    },
    changes=CHANGES,
    curves=CURVES,
    # An autopilot's own angle passes a filter, and identifies no arm.
    computed={("alpha", "filter_s"): (0.045, (0.0, 0.09)), ("alpha", "scale"): (0.03, (-0.06, 0.06))},
    filters={"a_z": 0.01},
    relative_to=1.0,
    arms_are_causes=True,
    follows={"elevator": ("q", "M_delta_e")},
    words={"elevator": "the elevator", "q": "pitch rate"},
    inputs_to_fly={"elevator": "an elevator doublet"},
    equations={_F: "alpha", _M: "q"},
    sensors={_ANGLE: "alpha", _GYRO: "q", _SEAT_BLOCK: "a_z"},
    readings={
        "q": ("pitch rate", "pitch_rate_skew", _GYRO),
        "a_z": ("acceleration", "accelerometer_skew", ""),
        "alpha": ("angle of attack", "alpha_skew", ""),
    },
    blocks={"elevator": "input"},
    example="M_alpha",
    gust=("gusts", "turbulence", "sigma_w_m_s"),
    natural_size=natural_size,
    prior=priors,
    weak={"Z_q": Z_Q_STD, "M_steady": 1.0},
    qualities=qualities,
)  # fmt: skip
"""The pitch axis. The bias of q is no parameter, because it cannot be distinguished from the constants of
trim."""
