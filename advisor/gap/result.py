"""Results of the diagnosis: verdict, sentence, causes and evidence."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import hypot, nan
from typing import Literal

from advisor.flight.instruments.atmosphere import AirData
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.alternative import Weighed
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray
from advisor.words.axes import AXES, AxisName
from advisor.words.quantities import NORMAL_95

GapVerdict = Literal["none", "parameters", "effect", "unknown", "untested"]
"""Verdict of a diagnosis. ``untested`` means that no simulator was given and no effect was found; JSON writes
null."""
IMPROVING: frozenset[str | None] = frozenset(("effect", "parameters"))
"""Verdicts after which the simulator can be improved."""
VISIBLE = 0.05
"""Least gap that counts as visible: mean square error over the floor's square, minus 1."""


@dataclass(frozen=True, slots=True)
class Value:
    """A number and its standard deviation, in one unit."""

    value: float
    std: float

    def agreeing(self, other: "Value") -> "Value":
        """Return the number with an interval that contains another reading's value."""
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
        """Half-width of the 95 % interval of the flight's value."""
        return NORMAL_95 * self.found.std

    @property
    def differs(self) -> bool:
        """Whether the 95 % interval excludes the simulator's value."""
        return abs(self.found.value - self.given) > self.half

    @property
    def percent(self) -> float | None:
        """Change of the derivative's size, per cent of the simulator's; None with another sign, or from
        zero."""
        return 100.0 * (self.found.value / self.given - 1.0) if self.given * self.found.value > 0.0 else None


@dataclass(frozen=True, slots=True)
class Gap:
    """Gap of the simulator on held-out manoeuvres: mean square error over the floor's square, minus 1."""

    before: float = nan
    """Gap of the simulator as given, as the mean over the channels."""
    after: float = nan
    """Gap of the final model, as the mean over the channels; NaN with a single manoeuvre."""
    floor: Mapping[str, float] = field(default_factory=dict)
    """Standard deviation of the residual where nothing was flown, by channel, in the channel's SI unit."""
    floor_note: str = ""
    """Source of the floor: measured, or stated because the record was filtered before storage."""
    by_channel: Mapping[str, float] = field(default_factory=dict)
    """Gap of each channel; empty for a flight that no model fits."""
    by_channel_after: Mapping[str, float] = field(default_factory=dict)
    by_maneuver: tuple[tuple[int, float, float], ...] = ()
    """Number of each manoeuvre, with its gap before and after."""
    by_phase: Mapping[str, float] = field(default_factory=dict)
    """Gap of the simulator as given, for ``step edge``, ``plateau`` and ``free response``."""
    by_band_hz: tuple[tuple[float, float, float], ...] = ()
    """Limits of each frequency band in Hz, with the band's share of the pitch-rate error's power."""
    by_air: float = 0.0
    """Part of the gap that the likeliest course of moving air removes from the final model."""


@dataclass(frozen=True, slots=True)
class Cause:
    """One candidate explanation of the gap."""

    effect: str
    block: str
    probability: float
    """Probability that the effect causes the gap, or is its main cause among several."""
    parameters: Mapping[str, Value]
    cannot_be_told_from: tuple[str, ...]
    tell_apart_by: str
    gap_after: float
    present: bool = False
    """Whether the effect is part of the final model; if not, it is an alternative."""
    of: str = ""
    """Control or output at which the effect acts, on an axis with several of them; ``air`` for gusts."""
    named: str = ""
    """Name of the effect with its control or output, as the report prints it; empty without these."""
    sentence: str = ""
    """Sentence of the report about this effect at its control or output."""
    gain: Value | None = None
    """Log likelihood gained on unseen manoeuvres over fitted derivatives alone, nats."""
    peaks: Mapping[str, float] = field(default_factory=dict)
    """Largest error of each judged rate with the effect in the simulator, rad/s."""

    @property
    def name(self) -> str:
        """Name of the effect in documents."""
        return (self.named or self.effect).replace(" ", "_")


@dataclass(frozen=True, slots=True)
class Where:
    """The block of the simulator in which the gap arises."""

    block: str = ""
    """Name of the block; empty for a diagnosis that names none."""
    share: float = 0.0
    ranking: tuple[tuple[str, float], ...] = ()
    """Blocks with their scores relative to the best block, which scores 1."""


def ranked(scores: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    """Return blocks with their scores relative to the largest score, which is first."""
    best = max([*scores.values(), 1e-12])
    return tuple((b, round(scores[b] / best, 4)) for b in sorted(scores, key=lambda b: -scores[b]))


@dataclass(frozen=True, slots=True)
class MissingLaw:
    """A force or moment without a name, as a curve over one quantity."""

    equation: str
    """Letter of the equation in which the law acts: Z or M in pitch; Y, L or N in roll and yaw."""
    variable: str
    """Quantity on which the law depends most, as a signal of ``added_term.SIGNALS``; angles count from trim.
    ``t``: the time of flight."""
    share: float
    """Share of the weighted residual's power that a law over the quantity explains."""
    curve: tuple[tuple[float, float, float], ...]
    """Quantity, law in 1/s or rad/s², and half the 95 % interval of its mean, at each point of the curve."""
    coefficient: Value
    """Coefficient of the formula ``nearest``, SI."""
    nearest: str
    """Formula nearest to the curve, next to a line: ``q*abs(q)``; empty over time."""
    runner_up: str = ""
    """Formula that comes next."""

    @property
    def term(self) -> str:
        """Term to add to the estimate: ``M:q*abs(q)``; empty over time."""
        return f"{self.equation}:{self.nearest}" if self.nearest else ""


@dataclass(frozen=True, slots=True)
class Shrink:
    """Shrink of the gap on manoeuvres that were held out of the fit.

    In moving air the likeliest course of the air is removed from the gap. The air's course is fitted to the
    held-out samples, because no other manoeuvre predicts a gust.
    """

    holdout: tuple[int, ...]
    """Numbers of the held-out manoeuvres."""
    before: float
    after: float
    percent: float
    ci95_percent: tuple[float, float]
    beyond_air_percent: float | None = None
    """Share of the innovation power beyond noise that the effects remove on held-out manoeuvres, per cent.
    The filter of the innovations contains moving air. Without an effect, the share of the gap that fitted
    derivatives remove. In still air the value is None."""
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
    """Tolerance of 14 CFR Part 60, Appendix A, test 2.c.10, in SI units; None for a channel without
    tolerance."""
    before: float
    """Largest error of the simulator as given, on held-out manoeuvres, in SI units."""
    after: float | None
    """Largest error with the effects added to the simulator; None where no effect was added."""
    theil: tuple[float, float | None]
    """Theil's inequality coefficient of the simulator as given, and with the effects."""

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
    """Gap of the user's own simulator on held-out manoeuvres."""

    simulator: str
    """Description of the simulator for people."""
    maneuvers: tuple[int, ...]
    """Numbers of the manoeuvres on which the gap is measured. If something was found, these manoeuvres were
    part of no search and no fit."""
    before: float
    """Gap of the simulator as given."""
    after: float | None
    """Gap with the effects and derivatives of an export in the simulator. Equal to ``before`` without a
    change; None if the changed simulator does not fly or no manoeuvre was held out."""
    percent: float | None
    """Shrink of the gap by the changes in the simulator, per cent; 0 without a change."""
    on_paper: tuple[str, ...]
    """Corrections that the simulator cannot take: effects, ``derivatives``, ``its own servo``."""
    qualification: tuple[Qualification, ...]
    after_air_and_instruments: float | None = None
    """Gap ``after`` without the part that the air's course and natural instrument errors explain. This part
    of the gap is not counted as shrink. None without a change."""
    refused: str = ""
    """Reason why the simulator does not fly with the effects; empty otherwise."""


@dataclass(frozen=True, slots=True)
class TrimDifference:
    """One quantity of the trimmed flight, in simulator and aircraft, averaged over the manoeuvres."""

    quantity: str
    """Name of the quantity: ``alpha`` and ``elevator`` in rad, ``throttle`` from 0 to 1."""
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


@dataclass(frozen=True, kw_only=True)
class Diagnosis(Weighed):
    """The complete result of a diagnosis of one axis."""

    axis: AxisName = AXES[0]
    verdict: GapVerdict
    sentence: str
    """One sentence for the crew."""
    gap: Gap
    where: Where = Where()
    causes: tuple[Cause, ...] = ()
    """Effects of the model in the order in which they were found, then alternatives, likeliest first."""
    shrink: Shrink | None = None
    """Shrink of the gap; None if no manoeuvre could be held out, or without a gap."""
    waterfall: tuple[tuple[str, float], ...] = ()
    """Gap after the addition of each effect, in the order of addition."""
    cannot_see: tuple[Unseen, ...] = ()
    kinematics: KinematicCheck | None = None
    """Angle of attack against the motion; None for roll and yaw."""
    model: Mapping[str, Value]
    """Parameters of the final model at the reference speed, by name."""
    not_identifiable: Mapping[str, str] = field(default_factory=dict)
    """Reason for each parameter that the flight does not determine, by the parameter's name."""
    instruments: Mapping[str, Value] = field(default_factory=dict)
    """Nuisance parameters of the fit: lag or delay of each servo and clock."""
    peaks: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Largest error of each judged rate, rad/s, with the derivatives of ``simulator``, and with
    ``fitted_derivatives`` and no effect."""
    reference_airspeed_m_s: float | None = None
    """Air speed of the derivatives: measured, from the file, or from the motion; None if unknown."""
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Section ``effects`` of the improved simulator's aircraft file."""
    yardsticks: Mapping[str, tuple[Yardsticks, Yardsticks]] = field(default_factory=dict)
    """Fidelity measures of each channel, for the simulator as given and for the final model."""
    share_irreducible: float = nan
    """Share of the final model's error that is noise and moving air. The other part of the remaining gap is
    model error."""
    derivatives: tuple[ComparedDerivative, ...] = ()
    """Derivatives of simulator and flight, those that differ most first; empty without a simulator."""
    traces: tuple[Trace, ...] = ()
    notes: tuple[str, ...] = ()
    static: tuple[str, ...] = ()
    """Sentences on errors that no motion shows, such as trim and air speed."""
    taken_back: tuple[str, ...] = ()
    """Sentences on corrections that raise the gap of held-out manoeuvres, and that the improved simulator
    lacks. The diagnosis' sentence ends with these sentences."""
    corrects: bool = True
    """Whether the corrections do not increase the gap of held-out manoeuvres."""
    trims: tuple[TrimDifference, ...] = ()
    """Trimmed flight of the user's own simulator and of the aircraft."""
    in_simulator: InSimulator | None = None
    """Gap of the user's own simulator; None without a named simulator."""
    maneuvers: tuple[int, ...] = field(default=())
    air: AirData | None = None
    """Air of the manoeuvres: kind of the air speed, and density; None unless requested."""
    airspeed_excess: float = 0.0
    """Relative excess of the true air speed over the used air speed, from the final model."""
    missing_law: MissingLaw | None = None
    """The law that an answer without a name lacks; None for other answers and for other blocks."""
    structured: Estimate | None = None
    """Joint estimate with the parameters that the user holds and the terms that the user adds; None without
    both."""
    although_refused: tuple[int, ...] = ()
    """Numbers of used manoeuvres that ``advisor analyze`` refuses because of their data."""

    @property
    def improves(self) -> bool:
        """Whether the diagnosis gives an improved simulator, by an effect or by other derivatives."""
        return self.verdict in IMPROVING and self.corrects


def spelled(effect: str) -> str:
    """Return the name of an effect for sentences; a skew is a late time stamp."""
    channel = effect.removesuffix("_skew")
    return (effect if channel == effect else f"late_{channel}_stamps").replace("_", " ")
