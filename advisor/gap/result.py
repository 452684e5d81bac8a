"""Results of the diagnosis: verdict, sentence, causes and evidence."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.flight.signals.messages import FloatArray
from advisor.gap.decision import Decision

GapVerdict = Literal["none", "parameters", "effect", "unknown", "untested"]
"""Verdict of a diagnosis. ``untested``: no simulator was given and no effect was found; JSON writes null."""
VISIBLE = 0.05
"""Least gap that is called visible: mean square error over the floor's square, minus 1."""


@dataclass(frozen=True, slots=True)
class Value:
    """A number and its standard deviation, in the unit of the number."""

    value: float
    std: float


@dataclass(frozen=True, slots=True)
class Gap:
    """Gap of the simulator on held-out manoeuvres: mean square error over the floor's square, minus 1."""

    before: float
    """Mean over the channels, with the simulator as given."""
    after: float
    """Mean over the channels, with the final model."""
    floor: Mapping[str, float]
    """Standard deviation of the residual where nothing was flown, by channel, in the channel's SI unit."""
    floor_note: str
    """How the floor was found: measured, or stated because the record was filtered before storage."""
    by_channel: Mapping[str, float]
    by_channel_after: Mapping[str, float]
    by_maneuver: tuple[tuple[int, float, float], ...]
    """Manoeuvre number, gap before, gap after."""
    by_phase: Mapping[str, float]
    """Gap before, for ``step edge``, ``plateau`` and ``free response``."""
    by_band_hz: tuple[tuple[float, float, float], ...]
    """Band limits in Hz, and the band's share of the power of the pitch-rate error."""


@dataclass(frozen=True, slots=True)
class Cause:
    """One candidate explanation of the gap."""

    effect: str
    block: str
    probability: float
    """Probability that the effect causes the gap, or is its main cause where several are present."""
    parameters: Mapping[str, Value]
    cannot_be_told_from: tuple[str, ...]
    tell_apart_by: str
    gap_after: float
    present: bool = False
    """Whether the effect is part of the final model; if not, it is an alternative."""


@dataclass(frozen=True, slots=True)
class Where:
    """The block of the simulator in which the gap arises."""

    block: str
    share: float
    ranking: tuple[tuple[str, float], ...]
    """Blocks with their scores; the best explanation scores 1."""


@dataclass(frozen=True, slots=True)
class Shrink:
    """Shrink of the gap on manoeuvres whose parameters were fitted without them.

    In moving air the likeliest course of the air is removed. That course is fitted to the same samples,
    because no other manoeuvre predicts it.
    """

    holdout: tuple[int, ...]
    """Numbers of the held-out manoeuvres."""
    before: float
    after: float
    percent: float
    ci95_percent: tuple[float, float]
    beyond_air_percent: float | None = None
    """Share of the innovation power beyond noise that the effects remove, in per cent, on held-out
    manoeuvres. The filter of the innovations knows the moving air. Without an effect: share of the gap that
    fitted derivatives remove. None in still air."""
    by_numbers_percent: float | None = None
    """Share of the gap, in per cent, that fitted derivatives remove without any effect. None where the file's
    are right."""


@dataclass(frozen=True, slots=True)
class Course:
    """Slope of one quantity in time, over the manoeuvres of a flight."""

    quantity: str
    """``elevator_trim`` (rad): elevator that balances the moment at zero angle of attack. ``zero_lift_alpha``
    (rad). ``attitude`` (rad): zero of the attitude relative to angle of attack and climb. ``a_z_offset``
    (m/s²)."""
    slope_per_s: float
    std_per_s: float
    """Standard deviation of the slope, by the scatter of the manoeuvres about the line."""
    maneuvers: int

    @property
    def sigmas(self) -> float:
        """Slope in its standard deviations."""
        return abs(self.slope_per_s) / max(self.std_per_s, 1e-300)


@dataclass(frozen=True, slots=True)
class Unseen:
    """An effect that this log cannot show, and the channel or manoeuvre that would show it."""

    effect: str
    because: str
    would_need: str


@dataclass(frozen=True, slots=True)
class Yardsticks:
    """Published measures of fidelity for one channel, on held-out manoeuvres."""

    theil: float
    """Theil's inequality coefficient, 0 to 1; values below 0.25 to 0.3 are commonly accepted."""
    bias: float
    variance: float
    covariance: float
    """Share of the mean square error; with ``bias`` and ``variance`` the shares add up to 1."""
    r2: float
    within_tolerance: float | None
    """Share of the samples within the tolerance of simulator qualification; None where no tolerance is
    published."""


@dataclass(frozen=True, slots=True)
class Qualification:
    """One channel of the user's simulator, compared with the tolerance for qualifying training simulators."""

    channel: str
    limit: float | None
    """Tolerance of 14 CFR Part 60, Appendix A, test 2.c.10, in SI units; None where none is published."""
    before: float
    """Largest error of the simulator as given, on held-out manoeuvres, in SI units."""
    after: float | None
    """Largest error with the effects added to the simulator; None where no effect was added."""
    theil: tuple[float, float | None]
    """Theil's inequality coefficient before and after."""

    @property
    def passes_before(self) -> bool | None:
        """Whether the simulator as given stays within the limit; None without a limit."""
        return None if self.limit is None else self.before <= self.limit

    @property
    def passes_after(self) -> bool | None:
        """Whether the simulator with the effects stays within the limit; None without a limit or effects."""
        return None if self.limit is None or self.after is None else self.after <= self.limit


@dataclass(frozen=True, slots=True)
class InSimulator:
    """The gap of the user's own simulator on held-out manoeuvres."""

    simulator: str
    """Description of the simulator for people."""
    before: float
    """Gap of the simulator as given."""
    after: float | None
    """Gap with the effects added to the simulator; None where no effect was added."""
    percent: float | None
    on_paper: tuple[str, ...]
    """Corrections that the simulator cannot take: effects, ``derivatives``, ``its own servo``."""
    qualification: tuple[Qualification, ...]
    refused: str = ""
    """Why the simulator does not fly with the effects; empty where it does, or where none was added."""


@dataclass(frozen=True, slots=True)
class Trace:
    """Measured and simulated values of one channel in one manoeuvre, at the channel's own stamps, for
    plotting."""

    number: int
    channel: str
    t: FloatArray
    measured: FloatArray
    before: FloatArray
    """Values of the simulator as given."""
    after: FloatArray
    """Values of the final model."""


@dataclass(frozen=True)
class Diagnosis:
    """The complete result of a diagnosis."""

    verdict: GapVerdict
    sentence: str
    """One sentence for the crew."""
    gap: Gap
    where: Where
    causes: tuple[Cause, ...]
    shrink: Shrink | None
    """None where no manoeuvre could be held out, or where there is no gap."""
    waterfall: tuple[tuple[str, float], ...]
    """Effects in the order of addition, each with the gap after its addition."""
    cannot_see: tuple[Unseen, ...]
    kinematics: KinematicCheck
    model: Mapping[str, Value]
    """The eight parameters of the final model at the reference speed."""
    reference_airspeed_m_s: float | None
    """Speed of the derivatives: as measured, or of the file, or implied by the motion; None where unknown."""
    effects: Mapping[str, Mapping[str, float]]
    """Section ``effects`` of the improved simulator's aircraft file."""
    yardsticks: Mapping[str, tuple[Yardsticks, Yardsticks]]
    """Channel to the measures of the simulator as given and of the final model."""
    share_irreducible: float
    """Share of the final model's error that is noise and moving air. The rest is model error."""
    courses: tuple[Course, ...] = ()
    """Slopes of trims and offsets over the flight: what creeps between manoeuvres."""
    decisions: tuple[Decision, ...] = ()
    """Every statistic that was compared with a limit, in the order of the comparisons."""
    traces: tuple[Trace, ...] = ()
    notes: tuple[str, ...] = ()
    in_simulator: InSimulator | None = None
    """The gap of the user's own simulator; None where no simulator was named."""
    maneuvers: tuple[int, ...] = field(default=())
    height_m: float | None = None
    """Mean height of the manoeuvres in m; None where the height was not recorded."""
    true_over_read: float = 1.0
    """Factor from the air speed as the aircraft reads it to the true one."""


def spelled(effect: str) -> str:
    """Return the name of an effect as people write it."""
    return effect.replace("_", " ")
