"""The lateral-directional axis: sideslip β, roll rate p, yaw rate r and bank φ, by aileron and rudder.

    β̇ = s·(Y_β·β + Y_δa·δa + Y_δr·δr + Y_0) + Y_p·p + Y_r·r + sin α·p - cos α·r + (g/V)·cos θ·sin φ
    ṗ = s²·(L_β·β + L_δa·δa + L_δr·δr + L_0) + s·(L_p·p + L_r·r)
    ṙ = s²·(N_β·β + N_δa·δa + N_δr·δr + N_0) + s·(N_p·p + N_r·r)
    φ̇ = p + tan θ·(q·sin φ + r·cos φ)

α, θ, V and q are known signals. L and N hold the products of inertia (Klein & Morelli, *Aircraft System
Identification*, Ch. 3). Outputs are p, r, φ, a_y = V·(the parameters' part of β̇) and, where a vane measures
it, β + (x_β/V)·r. A positive aileron rolls the aircraft to the left, and a positive rudder yaws it to the
left.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS, SPEED_EXPONENTS
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.model.axis import CONSTANT, SINE, TURN, Around, Axis, Known, Prior, Read, Reported, Term
from advisor.process.arrays import FloatArray

AIR_SPEED_STD = 0.02
"""Prior standard deviation of the relative excess of the true over the read air speed. The read speed may be
an indicated one, and a static port reads a pressure that the wing changes."""
ANGLE_OF_ATTACK_STD = 0.01
"""Prior standard deviation of the excess of the true over the read angle of attack, rad. An autopilot's own
angle is 0.2 to 0.5 deg off, and a vane is mounted no better. With an angle of half a degree too much, rolling
turns into sideslip that no side force explains."""
SIDE_FORCE_STD = 0.05
"""Prior standard deviation of Y_p and Y_r about zero, without unit. C_Yp and C_Yr of 0.4 give 0.01 for a jet
of 15 t and 0.04 for an aircraft of 3 kg."""
SIDE_FORCE_OVER_WEIGHT = 2.0
"""Prior mean and standard deviation of |C_Yβ|/C_L, without unit. Fits give -Y_β·V/g of 0.8 on an indoor
aircraft, 1.2 at 3 kg, 2.7 on a jet and 4.9 on a fighter."""
YAW_BY_ROLLING = 0.2
"""Prior standard deviation of N_p over L_p, without unit. C_np of C_L/8 with C_lp of -0.45 gives 0.03 to 0.2.
Fits give 0.01 on a fighter, 0.05 on a jet, 0.09 at 3 kg and -0.3 on an indoor aircraft."""
ROLL_BY_YAWING = 1.0
"""Prior standard deviation of L_r over L_p, without unit. C_lr of C_L/4 with C_lp of -0.45 gives 0.2 to 0.8.
Fits give 0.2 on a fighter, 0.3 on a jet and at 3 kg, and 0.7 on an indoor aircraft."""
_FACTORS = {"beta": "beta", "p": "p", "r": "r", "delta_a": "aileron", "delta_r": "rudder"}
_STATES = {"Y": "beta", "L": "p", "N": "r"}
_AIR, _ALPHA, _VANE, _SEAT = (
    ("airspeed", "excess"), ("alpha", "excess_rad"), ("beta", "arm_m"), ("a_y", "arm_m"),
)  # fmt: skip


def _term(name: str, factor: str) -> Term:
    return Term(name, _STATES[name[0]], factor, SPEED_EXPONENTS[name])


def natural_size(theta: FloatArray) -> Mapping[str, float]:
    """Return the typical size of each derivative on an aircraft with these derivatives (15,).

    Two rates set the size: the roll mode's, |L_p|, and the Dutch roll's, √|N_β|. A control has the
    size of the larger of its two moments; its force turns the path as fast as this moment does within 1/ω.
    A control that was not flown has no moment yet; its size is ω² for a radian.
    """
    value: dict[str, float] = dict(zip(SIDE_PARAMETERS, (abs(float(v)) for v in theta), strict=True))
    yaw = max(np.sqrt(value["N_beta"]), 1e-6)
    roll = max(value["L_p"], yaw)
    sizes = {"Y_beta": yaw, "Y_p": 1.0, "Y_r": 1.0, "L_p": roll, "L_r": roll, "N_p": yaw, "N_r": yaw}
    sizes |= {"L_beta": max(value["L_beta"], yaw**2), "N_beta": yaw**2}
    for control in ("delta_a", "delta_r"):
        power = max(value[f"L_{control}"], value[f"N_{control}"]) or yaw**2
        sizes |= {f"L_{control}": power, f"N_{control}": power, f"Y_{control}": power / yaw}
    return sizes


def priors(theta: FloatArray, flown: Sequence[str], tells_force: bool, airspeed_m_s: float) -> Prior:
    """Return the priors for derivatives near ``theta`` (15,).

    Y_p and Y_r are a few per cent on every aircraft. The derivatives of a control that hardly moves have the
    size of those of the other control. Without a measured side force or sideslip, gravity and air speed give
    the size of Y_β in level flight. Strip theory then gives N_p and L_r (Etkin & Reid, *Dynamics of Flight*,
    Ch. 5).
    """
    mean = dict.fromkeys(SIDE_PARAMETERS, 0.0)
    std = {**dict.fromkeys(SIDE_PARAMETERS, np.inf), **LATERAL.weak}
    size = natural_size(theta)
    moved = [suffix for suffix, name in CONTROLS.items() if name in flown]
    for suffix in CONTROLS.keys() - moved:
        for letter in "YLN":
            usual = max((size[f"{letter}_{other}"] for other in moved), default=np.inf)
            std[f"{letter}_{suffix}"] = usual if usual > 0.0 else np.inf
    if not tells_force:
        mean["Y_beta"] = -SIDE_FORCE_OVER_WEIGHT * GRAVITY_M_S2 / airspeed_m_s
        std["Y_beta"] = -mean["Y_beta"]
        std |= {"N_p": YAW_BY_ROLLING * size["L_p"], "L_r": ROLL_BY_YAWING * size["L_p"]}
    return Prior(np.array(list(mean.values())), np.array(list(std.values())))


@dataclass(frozen=True, slots=True)
class Modes:
    """Modes of the lateral motion; None for a mode that the aircraft does not have."""

    dutch_roll: complex | None
    """Dutch roll eigenvalue with positive imaginary part, 1/s."""
    roll: float | None
    """Eigenvalue of the roll subsidence, 1/s."""
    spiral: float | None
    """Eigenvalue of the spiral, 1/s."""


def modes_of(a: FloatArray) -> Modes:
    """Return the modes of a state matrix (4, 4).

    The faster oscillation is the Dutch roll. Roll and spiral modes that form one oscillation are not
    separate.
    """
    values = np.linalg.eigvals(a)
    swinging = sorted((complex(v) for v in values if v.imag > 1e-9), key=abs)
    real = sorted(float(v.real) for v in values if abs(v.imag) <= 1e-9)
    oscillation = swinging[-1] if swinging else None
    if len(real) != 2:
        return Modes(oscillation, None, None)
    return Modes(oscillation, min(real, key=lambda v: -abs(v)), max(real, key=lambda v: -abs(v)))


def qualities(theta: FloatArray, around: Around) -> tuple[Mapping[str, Reported], Mapping[str, str]]:
    """Return frequency and damping of the Dutch roll, the roll mode's time constant and the spiral's pole.

    Let λ be a simple eigenvalue of A with right and left eigenvectors v and w. A change dA of the matrix
    changes it by dλ = wᵀ·dA·v/(wᵀ·v) (Wilkinson, *The Algebraic Eigenvalue Problem*, 1965, ch. 2). The Dutch
    roll has the frequency ω = |λ| and the damping ζ = -Re λ/ω, and the roll mode has the time constant -1/λ.
    """
    a = LATERAL.linear(theta, around).matrix
    modes, made, missing = modes_of(a), {}, {}
    if modes.dutch_roll is None:
        missing["dutch_roll"] = "the aircraft has no oscillation in yaw at these values"
    else:
        value, slope = modes.dutch_roll, _slope(a, modes.dutch_roll)
        size = abs(value)
        by_size = (value.conjugate() * slope).real / size
        by_damping = -slope.real / size + value.real * by_size / size**2
        made["dutch_roll_omega"] = Reported(size, by_size)
        made["dutch_roll_zeta"] = Reported(-value.real / size, by_damping)
    if modes.roll is None or modes.spiral is None:
        missing["roll"] = missing["spiral"] = "roll and spiral oscillate together at these values"
    else:
        made["roll_time_constant"] = Reported(-1.0 / modes.roll, _slope(a, modes.roll).real / modes.roll**2)
        made["spiral_pole"] = Reported(modes.spiral, _slope(a, modes.spiral).real)
    return made, missing


def _slope(a: FloatArray, value: complex) -> np.ndarray:
    """Return the gradient of an eigenvalue of ``a`` over the 15 derivatives."""
    values, right = np.linalg.eig(a)
    k = int(np.argmin(np.abs(values - value)))
    left = np.linalg.inv(right)[k]
    moved = np.zeros(len(LATERAL.shared), np.complex128)
    for j, (row, column, _) in enumerate(LATERAL.place[: len(LATERAL.shared)]):
        if column < len(a):
            moved[j] = left[row] * right[column, k]
    return moved


LATERAL = Axis(
    key="lateral",
    name="roll and yaw",
    states=("beta", "p", "r", "bank"),
    inputs=("aileron", "rudder"),
    outputs=("p", "r", "bank", "a_y", "beta"),
    shared=tuple(_term(name, _FACTORS[name[2:]]) for name in SIDE_PARAMETERS),
    constants=tuple(_term(f"{letter}_0", CONSTANT) for letter in _STATES),
    biases=("p", "a_y"),
    factors={
        "sin alpha": lambda x: np.sin(x["alpha"]),
        "-cos alpha": lambda x: -np.cos(x["alpha"]),
        "weight": lambda x: GRAVITY_M_S2 / x["airspeed"] * np.cos(x["theta"]),
        "q tan theta": lambda x: x["q"] * np.tan(x["theta"]),
        "tan theta": lambda x: np.tan(x["theta"]),
        "vane": lambda x: x[_VANE] / x["airspeed"],
        "1/V": lambda x: 1.0 / x["airspeed"],
        "V": lambda x: x["airspeed"],
        "seat": lambda x: x[_SEAT],
    },
    turning=(
        Known("beta", "p", "sin alpha"), Known("beta", "r", "-cos alpha"), Known("beta", SINE, "weight"),
        Known("bank", "p", CONSTANT), Known("bank", SINE, "q tan theta"), Known("bank", TURN, "tan theta"),
        Known("beta", SINE, "weight", _AIR, -1.0), Known("beta", "p", "-cos alpha", _ALPHA, -1.0),
        Known("beta", "r", "sin alpha", _ALPHA),
    ),
    seen=(
        Read("p", "p"), Read("r", "r"), Read("bank", "bank"), Read("beta", "beta"), Read("beta", "r", "vane"),
        Read("a_y", "beta", "V", of_rate=True), Read("a_y", "r", "seat", of_rate=True),
        Read("beta", "r", "vane", False, _AIR, -1.0), Read("a_y", "beta", "V", True, _AIR),
        Read("beta", "r", "1/V", False, _VANE),
    ),
    open=(_AIR, _ALPHA),
    instruments=(_AIR, _ALPHA, _VANE, _SEAT),
    bank="bank",
    yaw="r",
    needed=("p", "r", "bank"),
    given=("airspeed", "alpha", "theta", "q"),
    # Gyros of 0.007 deg/s/√Hz have 5e-4 rad/s at 20 Hz, and the model's errors are as large.
    floor={"p": 5e-4, "r": 5e-4, "bank": 5e-4, "a_y": 0.01, "beta": 5e-4},
    letters=_STATES,
    spoken={"phi": "bank", "p": "p", "r": "r", "beta": "beta"},
    hidden="beta",
    force="a_y",
    clocks=("bank", "a_y", "beta"),
    arms=("beta",),
    errors={_AIR: AIR_SPEED_STD, _ALPHA: ANGLE_OF_ATTACK_STD},
    follows={"aileron": ("p", "L_delta_a"), "rudder": ("r", "N_delta_r")},
    rivals={"aileron": "L_p"},
    words={
        "p": "roll rate", "r": "yaw rate", "bank": "bank angle", "theta": "pitch angle", "q": "pitch rate",
    },
    inputs_to_fly={"aileron": "an aileron doublet", "rudder": "a rudder doublet"},
    equations={"side_force": "beta", "rolling_moment": "p", "yawing_moment": "r"},
    sensors={
        "roll_rate_sensor": "p", "yaw_rate_sensor": "r", "attitude_sensor": "bank", "accelerometer": "a_y",
        "sideslip_sensor": "beta",
    },
    readings={
        "p": ("roll rate", "pitch_rate_skew", "pitch_rate_sensor"),
        "r": ("yaw rate", "pitch_rate_skew", "pitch_rate_sensor"),
        "bank": ("attitude", "attitude_skew", ""),
        "a_y": ("lateral acceleration", "accelerometer_skew", "accelerometer"),
        "beta": ("sideslip", "alpha_skew", "alpha_sensor"),
    },
    example="L_p",
    propeller=("aileron", "propeller roll", "The propeller rolls the real aircraft"),
    gust=("side gusts", "side_gusts", "sigma_v_m_s"),
    natural_size=natural_size,
    prior=priors,
    weak={"Y_p": SIDE_FORCE_STD, "Y_r": SIDE_FORCE_STD},
    qualities=qualities,
)  # fmt: skip
"""The lateral axis. Biases of r and φ are no parameters, because they cannot be distinguished from the
constants of trim."""
CONTROLS = LATERAL.controls
"""Name of each control, by the ending of its derivatives."""


@dataclass(frozen=True, slots=True)
class Trim:
    """Steady flight about which the lateral motion is linear."""

    airspeed_m_s: float
    alpha_rad: float = 0.0
    theta_rad: float = 0.0

    @property
    def around(self) -> Around:
        """Known signals of the flight, for ``Axis.linear``, with ideal instruments."""
        signals = {"airspeed": self.airspeed_m_s, "alpha": self.alpha_rad, "theta": self.theta_rad, "q": 0.0}
        return {**dict.fromkeys(LATERAL.instruments, 0.0), **signals}


def state_matrix(theta: FloatArray, trim: Trim) -> FloatArray:
    """Return A of ẋ = A·x about wings-level flight, shape (4, 4), for ``theta`` (15,) at reference speed."""
    return LATERAL.linear(theta, trim.around).matrix
