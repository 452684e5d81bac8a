"""State of an instrument examination: corrected channels, evidence and findings."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import floor, inf, log2

import numpy as np

from advisor.flight.instruments.measured import Evidence, Measured, pooled
from advisor.flight.signals.instrument_finding import InstrumentFinding, Quantity
from advisor.flight.signals.record import Channel
from advisor.words.quantiles import NORMAL_95

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
