"""Rows of results, one model for terminal, page, panes and CSV: parameters of an estimate, and channels."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import Any

from advisor.campaign.state import JudgedLateral, JudgedManeuver
from advisor.flight.signals.track import ChannelStatus
from advisor.oem.estimate import Estimate
from advisor.report.table import Table, digits
from advisor.words.digits import decimals_for, signed, with_half
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import DEG, Quantity, symbol
from advisor.words.quantities import PARAMETERS as PITCH
from advisor.words.quantities import SIDE_PARAMETERS as SIDE
from advisor.words.vehicle_time import clock

_QUANTITIES = {**PITCH, **SIDE}


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One parameter of an estimate, in the unit for people."""

    quantity: Quantity
    value: float
    """Estimate; NaN where the estimate does not tell the parameter."""
    half: float
    """Half of the 95 % interval, corrected for coloured residuals; NaN without a value."""
    half_if_white: float
    """Half of the 95 % interval by the Cramér-Rao bound; NaN without a value."""
    prior: float | None
    """Value of the aircraft file's model; None where the file has none."""
    reason: str = ""
    """Reason for which the estimate does not tell the parameter."""

    @property
    def is_known(self) -> bool:
        """Whether value and interval are numbers."""
        return isfinite(self.value) and isfinite(self.half)

    @property
    def cell(self) -> str:
        """Value with half its interval: ``−48.3 ± 2.1``."""
        return with_half(self.value, self.half) if self.is_known else "–"

    @property
    def prior_cell(self) -> str:
        """Value of the aircraft file with the decimals of the estimate."""
        return "–" if self.prior is None else signed(self.prior, decimals_for(self.half))

    @property
    def off_by(self) -> float | None:
        """Distance of the file's value from the estimate in standard deviations."""
        if self.prior is None or not self.is_known:
            return None
        return abs(self.value - self.prior) / self.half * NORMAL_95


def parameter_row(name: str, estimate: object, prior: Mapping[str, float]) -> ParameterRow:
    """Return one parameter of an estimate against the aircraft file's model, which may lack it."""
    quantity, stated = _QUANTITIES[name], prior.get(name)
    known = None if stated is None else stated * quantity.factor
    if not isinstance(estimate, Estimate):
        return ParameterRow(quantity, nan, nan, nan, known)
    if name in estimate.not_identifiable:
        return ParameterRow(quantity, nan, nan, nan, known, estimate.not_identifiable[name])
    k, half = estimate.names.index(name), NORMAL_95 * quantity.factor
    value = float(estimate.theta[k]) * quantity.factor
    return ParameterRow(
        quantity, value, half * float(estimate.std[k]), half * float(estimate.std_cr[k]), known
    )


def untold(estimate: Estimate) -> dict[str, list[str]]:
    """Return each reason for which derivatives are not told, with their symbols."""
    found: dict[str, list[str]] = {}
    for name, reason in estimate.not_identifiable.items():
        found.setdefault(reason, []).append(symbol(name))
    return found


def maneuver_line(judged: JudgedManeuver | JudgedLateral, room: int = 15) -> str:
    """Return one line for a verdict: number, time, input in ``room`` columns, verdict and reason."""
    span, verdict = judged.maneuver.span, judged.verdict
    at, mark = clock(span.start_s), "✓" if verdict.accepted else "✗"
    return f"{judged.maneuver.number:2d}  {at:>7}  {span.kind:<{room}}  {mark} {verdict.sentence}"


@dataclass(frozen=True, slots=True)
class InstrumentRow:
    """One parameter of the instruments that was estimated with the derivatives, in the unit for people."""

    name: str
    """Name in words."""
    cell: str
    """Value with half its 95 % interval."""
    stated: str
    """Value of the aircraft file; a dash without one."""
    unit: str


def instrument_rows(estimate: object, with_vane: bool) -> list[InstrumentRow]:
    """Return the nuisance parameters of the instruments, such as the servo's lag and a vane's place.

    Without a vane the place is that of a vane which would read like the angle of attack.
    """
    if not isinstance(estimate, Estimate):
        return []
    rows = []
    for one in estimate.instruments:
        key = one.name if with_vane or one.name != "vane_arm_m" else "no_vane_arm_m"
        name, unit, factor = _INSTRUMENTS.get(key, (one.name.replace("_", " "), "SI", 1.0))
        half = NORMAL_95 * factor * one.std
        stated = "–" if one.stated is None else signed(factor * one.stated, decimals_for(half))
        rows.append(InstrumentRow(name, with_half(factor * one.value, half), stated, unit))
    return rows


_INSTRUMENTS: Mapping[str, tuple[str, str, float]] = {
    "servo_lag_s": ("servo lag", "ms", 1e3),
    "command_delay_s": ("delay of the command", "ms", 1e3),
    "vane_arm_m": ("vane ahead of the centre of gravity", "m", 1.0),
    "no_vane_arm_m": ("α reads like a vane ahead of the centre of gravity", "m", 1.0),
    "alpha_delay_s": ("delay of α", "ms", 1e3),
    "accelerometer_arm_m": ("accelerometer ahead of the centre of gravity", "m", 1.0),
    "steady_moment_rad": ("steady moment, as elevator", "deg", DEG),
}
"""Instrument parameter to its name, unit and factor from SI."""


def channel_table(name: str, caption: str, channels: Mapping[str, ChannelStatus]) -> Table:
    """Return the table of the channels of a log: source, provenance, rate and largest gap."""
    return Table(
        name, caption, ("channel", "source", "provenance", "rate [Hz]", "largest gap [s]"),
        tuple(
            (channel, one.source, one.provenance, digits(one.rate_hz, 1), digits(one.largest_gap_s, 2))
            for channel, one in channels.items()
        ),
        frozenset({3, 4}),
    )  # fmt: skip


def message_table(name: str, messages: Sequence[Mapping[str, Any]]) -> Table:
    """Return the table of the messages of ``advisor.doctor/1``: rates, jitter and largest gap."""
    decimals = {"rate_hz": 1, "lowest_hz": 1, "renewed_hz": 1, "jitter_ms": 1, "largest_gap_s": 3}
    head = ("message", "rate [Hz]", "lowest [Hz]", "new [Hz]", "jitter [ms]", "gap [s]")
    rows = tuple((one["name"], *(digits(one[k], n) for k, n in decimals.items())) for one in messages)
    return Table(name, "How the messages arrive; gap: the largest.", head, rows, frozenset(range(1, 6)))
