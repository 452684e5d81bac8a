"""State of an instrument examination (corrected channels, evidence, findings), and the checks of every
axis.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import floor, inf, log2, pi

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.evidence import force_against_gravity
from advisor.flight.instruments.measured import ANY, Evidence, Measured, pooled, weigh
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import InstrumentFinding, Quantity
from advisor.words.quantities import NORMAL_95

Correction = Callable[[Channel], Channel]
REVERSED = "reversed"
FILTER_S = 0.015
"""Longest delay, s, of a gyro or an accelerometer by an autopilot's filters: 11 ms at 20 Hz, 15 ms at 15
Hz."""
SIGMAS = 3.0
"""Least distance of a delay from its normal range, in standard deviations, for a contradiction."""
ALLOWED = "; estimates use the shifted stamps"
PLAIN = {
    "q": "the pitch rate", "theta": "the pitch angle", "a_z": "the specific force", "alpha": "alpha",
    "p": "the roll rate", "bank": "the bank angle", "r": "the yaw rate", "a_y": "the side force",
    "beta": "the sideslip",
}  # fmt: skip
"""Name of each channel in a sentence."""


@dataclass(frozen=True, slots=True)
class Examined:
    """Result of an examination of one record's instruments."""

    channels: Mapping[str, Channel]
    """Channels without the errors that ``findings`` marks as used."""
    evidence: Evidence
    """Evidence of this record alone."""
    findings: tuple[InstrumentFinding, ...]
    """Contradictions of the instruments, from this and earlier evidence."""
    corrections: tuple[tuple[str, Correction], ...] = ()
    """Corrections of the recorded channels that give ``channels``, in their order, each with the channel's
    name.
    """

    def of_longer(self, recorded: Mapping[str, Channel]) -> "Examined":
        """Return this examination of a record's first part, applied to the whole record."""
        channels = dict(recorded)
        for name, correction in self.corrections:
            if name in channels:
                channels[name] = correction(channels[name])
        return replace(self, channels=channels)


class ExaminedRecords:
    """Examinations of the instruments of one axis, record after record.

    Parameters
    ----------
    examine
        Function that examines one record, with the evidence of earlier records.
    """

    def __init__(self, examine: Callable[[Mapping[str, Channel], Evidence], Examined]) -> None:
        self._examine = examine
        self.counted = 0
        """Number of counted records, over all power-ons."""
        self.begin()

    def begin(self) -> None:
        """Begin another power-on, without evidence."""
        self._evidence: Evidence = {}
        self._growing: tuple[float, float, Examined] | None = None
        self.findings: tuple[InstrumentFinding, ...] = ()
        """Contradictions of the instruments in the counted records of this power-on."""

    def examined(self, channels: Mapping[str, Channel]) -> Examined:
        """Return the examination of a record, with the evidence of the counted records."""
        return self._examine(channels, self._evidence)

    def so_far(self, channels: Mapping[str, Channel], begun_s: float, now_s: float) -> Examined:
        """Return the examination of a record that grows, repeated whenever the record's length has doubled.

        All examinations of a record together then cost at most twice the last one.
        """
        until_s = begun_s + 2.0 ** floor(log2(now_s - begun_s))
        if self._growing is None or self._growing[:2] != (begun_s, until_s):
            first = {name: channel.cut(-inf, until_s) for name, channel in channels.items()}
            self._growing = begun_s, until_s, self.examined(first)
        return self._growing[2].of_longer(channels)

    def count(self, evidence: Evidence, findings: tuple[InstrumentFinding, ...]) -> None:
        self.counted += 1
        self._evidence = pooled((self._evidence, evidence))
        self.findings = findings


class Work:
    """Corrected channels, evidence and findings during an examination."""

    def __init__(self, channels: dict[str, Channel], earlier: Evidence) -> None:
        self.channels = channels
        self._corrections: list[tuple[str, Correction]] = []
        self._earlier = earlier
        self.evidence: dict[str, Measured] = {}
        self.findings: list[InstrumentFinding] = []

    def has(self, *names: str) -> bool:
        """Return whether the record holds these channels."""
        return all(name in self.channels and len(self.channels[name]) > 1 for name in names)

    def learn(self, new: Evidence) -> Mapping[str, Measured]:
        """Add evidence, and return all evidence pooled with that of earlier records."""
        self.evidence |= new
        return pooled((self._earlier, self.evidence))

    @property
    def done(self) -> Examined:
        return Examined(self.channels, self.evidence, tuple(self.findings), tuple(self._corrections))

    def correct(self, name: str, correction: Correction) -> None:
        if name in self.channels:
            self._corrections.append((name, correction))
            self.channels[name] = correction(self.channels[name])

    def shift(self, name: str, by_s: float) -> None:
        """Shift the stamps of a channel to earlier times."""
        self.correct(name, lambda channel: replace(channel, t=channel.t - by_s))

    def divide(self, name: str, by: float) -> None:
        """Divide the values of a channel by a factor."""
        self.correct(name, lambda channel: replace(channel, y=channel.y / by))

    def contradict(
        self,
        channel: str,
        quantity: Quantity,
        stated: float | str | None,
        value: float | str,
        measured: Measured,
        text: str,
        fix: str,
        used: bool = False,
        removed_s: float = 0.0,
    ) -> None:
        """Add a contradiction to the findings."""
        self.findings.append(
            InstrumentFinding(
                channel, quantity, stated, value, measured.std, True, text, fix, used, removed_s
            )
        )


def hold_clocks(work: Work, rate: str, angle: str) -> None:
    """Compare the clock of a rate with that of its angle, and shift the late channel forward."""
    late = work.learn({}).get(f"{rate}_delay")
    if late is None or not work.has(rate, angle):
        return
    range_s = FILTER_S + half_intervals(work, rate, angle)
    channel, other = (rate, angle) if late.value > 0.0 else (angle, rate)
    if channel == angle and bool(np.all(np.isin(work.channels[angle].t, work.channels[rate].t))):
        # The autopilot integrates the rates of one message to the attitude of the same message.
        range_s = FILTER_S
    if abs(late.value) - SIGMAS * late.std <= range_s:
        return
    measured = Measured(abs(late.value), late.std)
    # An attitude is integrated from the gyro. Its lateness can be removed.
    be_late(work, channel, PLAIN[other], measured, used=channel == angle, shifted=(channel,))


def be_late(
    work: Work,
    channel: str,
    relative_to: str,
    late: Measured,
    *,
    used: bool,
    bound: bool = False,
    shifted: tuple[str, ...] = (),
) -> None:
    """Add a finding about the late clock of a channel, and shift the stamps in ``shifted`` forward."""
    name = PLAIN[channel]
    ms = f"{'at least ' if bound else ''}{1e3 * late.value:.0f} ± {1e3 * NORMAL_95 * late.std:.0f} ms"
    work.contradict(
        channel, "delay_s", None, late.value, late,
        f"{name} is {ms} late relative to {relative_to}" + (ALLOWED if used else ""),
        f"check the stamps of {name} ({work.channels[channel].source})", used,
        late.value if shifted else 0.0,
    )  # fmt: skip
    for moved in shifted:
        work.shift(moved, late.value)


def half_intervals(work: Work, *names: str) -> float:
    """Return half of the longest sampling interval, s, because a sample may represent any time within its
    interval.
    """
    return 0.5 / min(work.channels[name].rate_hz for name in names)


def with_error(measured: Measured) -> str:
    """Return the value with half of its 95 % interval in words."""
    half = NORMAL_95 * measured.std
    digits = max(0, int(np.ceil(-np.log10(max(half, 1e-6))))) if half < 1.0 else 0
    return f"{measured.value:.{digits}f} ± {half:.{digits}f}"


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
