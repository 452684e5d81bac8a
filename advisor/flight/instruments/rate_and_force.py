"""Checks of instruments on every axis: a rate against its angle, the unit of the force, and a wrong sign."""

from collections.abc import Callable
from math import pi

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.evidence import force_against_gravity
from advisor.flight.instruments.examined import PLAIN, REVERSED, Work, with_error
from advisor.flight.instruments.measured import ANY, Measured, weigh

_GYRO_WIDTH = 0.05
"""Prior standard deviation of the ratio of an angle to its integrated rate, as a share. In recorded
manoeuvres the pitch angle is 0.92 to 1.05 times the integrated pitch rate."""
_FORCE_WIDTH = 0.05
"""Prior standard deviation of an accelerometer's scale, as a share: calibration of 2 to 3 %, and mounting."""
FORCE_UNITS_M_S2 = {
    "m/s^2": 1.0,
    "g": GRAVITY_M_S2,
    "mg": GRAVITY_M_S2 / 1000.0,
    **{f"{n} counts a g": GRAVITY_M_S2 / n for n in (2048, 4096, 8192, 16384)},
}
"""Size of each unit in which accelerometers are sent, m/s². Counts are of 16-bit sensors of 16, 8, 4 and 2
g."""
_SENSES = {
    "q": ("nose up", "nose down", "the nose goes up"),
    "theta": ("nose up", "nose down", "the nose is up"),
    "p": ("right", "left", "the right wing goes down"),
    "bank": ("right", "left", "the right wing is down"),
    "r": ("right", "left", "the nose goes right"),
    "a_y": ("right", "left", "the force points right"),
    "beta": ("right", "left", "the wind comes from the right"),
}
"""Right and wrong sense of each channel, and its positive direction in words."""


def hold_rate(
    work: Work, measured: Measured | None, rate: str, angle: str, reversed_one: Callable[[], str]
) -> bool:
    """Compare a rate with its angle by the ratio of their movements, and return whether sign and unit agree.

    Parameters
    ----------
    reversed_one
        Function that returns the channel with the wrong sign, if the signs of both differ.
    """
    if measured is None or not work.has(rate, angle):
        return True
    units = {f"{rate} in deg/s": pi / 180.0, f"{angle} in deg": 180.0 / pi}
    weighed = weigh(measured, {REVERSED: -1.0, **units}, _GYRO_WIDTH)
    if not weighed.contradicts:
        return True
    observation = f"{PLAIN[angle]} moves {with_error(measured)} times as far as {PLAIN[rate]} says"
    if weighed.best == REVERSED:
        turned(work, reversed_one(), measured, observation)
    elif weighed.best == ANY:
        work.contradict(
            rate, "scale", 1.0, 1.0 / measured.value if measured.value else 0.0, measured, observation,
            f"check scale and unit of {PLAIN[rate]}",
        )  # fmt: skip
    else:
        channel, _, unit = weighed.best.partition(" in ")
        stated = "rad/s" if channel == rate else "rad"
        work.contradict(
            channel, "unit", stated, unit, measured, f"{PLAIN[channel]} is in {unit}: {observation}",
            f"send {PLAIN[channel]} in {stated}",
        )  # fmt: skip
    return False


def turned(work: Work, channel: str, measured: Measured, observation: str) -> None:
    """Report a channel with the wrong sign."""
    right, wrong, direction = _SENSES[channel]
    work.contradict(
        channel, "sign", right, wrong, measured, f"{PLAIN[channel]} has the wrong sign: {observation}",
        f"check the sign of {PLAIN[channel]} ({work.channels[channel].source}), positive where {direction}",
    )  # fmt: skip


def stated_force_unit(source: str) -> str:
    """Return the unit that MAVLink defines for the message of an accelerometer channel."""
    return "m/s^2" if source.startswith("HIGHRES_IMU") else "mg"


def hold_force_unit(work: Work) -> bool:
    """Compare the mean vertical force with gravity, correct a known unit or sign, and return whether the unit
    is known."""
    scale = work.learn(force_against_gravity(work.channels)).get("a_z_scale")
    if scale is None or not work.has("a_z"):
        return True
    source = work.channels["a_z"].source
    stated = stated_force_unit(source)
    units = {name: FORCE_UNITS_M_S2[stated] / size for name, size in FORCE_UNITS_M_S2.items()}
    factors = {name: factor for name, factor in units.items() if name != stated}
    factors |= {f"{REVERSED}, {name}": -factor for name, factor in units.items()}
    weighed = weigh(scale, factors, _FORCE_WIDTH)
    if not weighed.contradicts:
        return True
    observation = f"in the mean it reads {with_error(scale)} g where the motion is 1 g"
    if weighed.best == ANY:
        work.contradict(
            "a_z", "scale", 1.0, scale.value, scale, f"a_z has an unknown unit: {observation}",
            f"check unit and calibration of the accelerometer ({source})",
        )  # fmt: skip
        return False
    reverse, unit = weighed.factor < 0.0, weighed.best.removeprefix(f"{REVERSED}, ")
    other_unit = unit != stated
    said = " and ".join([*([f"in {unit}"] if other_unit else []), *(["z up"] if reverse else [])])
    work.contradict(
        "a_z", *(("unit", stated, unit) if other_unit else ("sign", "z down", "z up")), scale,
        f"a_z is {said}, not in {stated} with z down: {observation}; estimates use the unit and sign found",
        f"send {source} in {stated}, z down", used=True,
    )  # fmt: skip
    work.divide("a_z", weighed.factor)
    for name in ("a_x", "a_y"):
        work.divide(name, abs(weighed.factor))
    return True
