"""Results of the diagnosis: verdict, sentence, causes and evidence."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import hypot
from typing import Literal

from advisor.flight.instruments.atmosphere import AirData
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.flight.signals.messages import FloatArray
from advisor.gap.alternative import Weighed
from advisor.words.quantiles import NORMAL_95

GapVerdict = Literal["none", "parameters", "effect", "unknown", "untested"]
"""Verdict of a diagnosis. ``untested``: no simulator was given and no effect was found; JSON writes null."""
IMPROVING: frozenset[str | None] = frozenset(("effect", "parameters"))
"""Verdicts after which there is something to improve."""
VISIBLE = 0.05
"""Least gap that is called visible: mean square error over the floor's square, minus 1."""


@dataclass(frozen=True, slots=True)
class Value:
    """A number and its standard deviation, in the unit of the number."""

    value: float
    std: float

    def agreeing(self, other: "Value") -> "Value":
        """Return the number; its interval contains that of another reading of the log from which it
        differs."""
        apart = abs(self.value - other.value) / NORMAL_95
        return self if apart <= hypot(self.std, other.std) else Value(self.value, apart + other.std)


@dataclass(frozen=True, slots=True)
class ComparedDerivative:
    """A derivative of the simulator and of the flight, at the reference speed, SI."""

    name: str
    given: float
    """Value of the simulator: the aircraft file's, or that of the simulator's linear surrogate."""
    found: Value
    """Value of the final model."""

    @property
    def half(self) -> float:
        """Half of the 95 % interval of the flight's value."""
        return NORMAL_95 * self.found.std

    @property
    def differs(self) -> bool:
        """Whether the 95 % interval excludes the simulator's value."""
        return abs(self.found.value - self.given) > self.half

    @property
    def percent(self) -> float | None:
        """Change of the size, per cent of the simulator's; None with another sign, or from zero."""
        return 100.0 * (self.found.value / self.given - 1.0) if self.given * self.found.value > 0.0 else None


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
    by_air: float = 0.0
    """Part of the gap that the likeliest course of moving air removes from the final model."""


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


def ranked(scores: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    """Return blocks with their scores over the largest one, which stands first."""
    best = max([*scores.values(), 1e-12])
    return tuple((b, round(scores[b] / best, 4)) for b in sorted(scores, key=lambda b: -scores[b]))


@dataclass(frozen=True, slots=True)
class Shrink:
    """Shrink of the gap on manoeuvres whose parameters were fitted without them.

    In moving air the likeliest course of the air is removed. The air's course is fitted to the held-out
    samples, because no other manoeuvre predicts a gust.
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
    """Share of the gap, in per cent, that fitted derivatives remove without any effect. None where the
    file's derivatives are right."""


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
    """Share of the samples within the tolerance of simulator qualification; None without a published one."""


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
    maneuvers: tuple[int, ...]
    """Numbers of the manoeuvres on which the gap is measured. No search and no fit has used them, where
    something was found."""
    before: float
    """Gap of the simulator as given."""
    after: float | None
    """Gap with the effects and numbers of an export in the simulator. Equal to ``before`` where nothing was
    changed; None where the simulator does not fly with them, or where no manoeuvre could be kept apart."""
    percent: float | None
    """Shrink by what was changed, in per cent; 0 where nothing was changed."""
    on_paper: tuple[str, ...]
    """Corrections that the simulator cannot take: effects, ``derivatives``, ``its own servo``."""
    qualification: tuple[Qualification, ...]
    after_air_and_instruments: float | None = None
    """Gap ``after`` without what the air's course and the instruments' natural errors explain in the same
    samples. This part of the gap is not counted as shrink. None where nothing was changed."""
    refused: str = ""
    """Why the simulator does not fly with the effects; empty where it does, or where none was added."""


@dataclass(frozen=True, slots=True)
class TrimDifference:
    """One quantity of the trimmed flight, in the simulator and in the aircraft: means over the manoeuvres."""

    quantity: str
    """``alpha`` and ``elevator`` in rad, ``throttle`` from 0 to 1."""
    simulator: float
    aircraft: float
    std: float
    """Standard deviation of the mean difference."""


@dataclass(frozen=True, slots=True)
class Trace:
    """Measured and simulated values of one channel in one manoeuvre, at the channel's stamps, for plots."""

    number: int
    channel: str
    t: FloatArray
    measured: FloatArray
    before: FloatArray
    """Values of the simulator as given."""
    after: FloatArray
    """Values of the final model."""


@dataclass(frozen=True)
class Diagnosis(Weighed):
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
    """Share of the final model's error that is noise and moving air. The rest of the remaining gap is model
    error."""
    derivatives: tuple[ComparedDerivative, ...] = ()
    """Derivatives of simulator and flight, those that differ most first; empty without a simulator."""
    traces: tuple[Trace, ...] = ()
    notes: tuple[str, ...] = ()
    static: tuple[str, ...] = ()
    """Sentences on errors that no motion shows, which the sentence tells first: trim, air speed, numbers that
    differ together."""
    taken_back: tuple[str, ...] = ()
    """Sentences on corrections that raise the gap of manoeuvres kept apart, and that the improved simulator
    therefore lacks. The sentence ends with them."""
    trims: tuple[TrimDifference, ...] = ()
    """Trimmed flight of the user's own simulator and of the aircraft."""
    in_simulator: InSimulator | None = None
    """The gap of the user's own simulator; None where no simulator was named."""
    maneuvers: tuple[int, ...] = field(default=())
    air: AirData | None = None
    """Air of the manoeuvres: the kind of their air speed, and the density; None where nobody asked."""
    airspeed_excess: float = 0.0
    """Relative excess of the true air speed over the one in use, as the final model has it."""
    although_refused: tuple[int, ...] = ()
    """Numbers of the manoeuvres in use that ``advisor analyze`` refuses by their data alone."""

    @property
    def improves(self) -> bool:
        """Whether there is an improved simulator: by an effect, or by other numbers."""
        return self.verdict in IMPROVING


def spelled(effect: str) -> str:
    """Return the name of an effect as people write it; a skew is a late time stamp."""
    channel = effect.removesuffix("_skew")
    return (effect if channel == effect else f"late_{channel}_stamps").replace("_", " ")
