"""What the diagnosis says: verdict, sentence, evidence."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from advisor.flight.kinematics import KinematicCheck
from advisor.flight.messages import FloatArray
from advisor.gap.decision import Decision

Verdict = Literal["none", "parameters", "effect", "unknown", "untested"]
"""``untested``: no simulator was given, and the flight shows no effect either; the JSON document has null."""
VISIBLE = 0.05
"""Gap above the floor from which on there is something to explain."""


@dataclass(frozen=True, slots=True)
class Value:
    """A number and its standard deviation."""

    value: float
    std: float


@dataclass(frozen=True, slots=True)
class Gap:
    """The simulator's error on manoeuvres kept out: mean square over the floor's square, minus 1."""

    before: float
    """Mean over channels."""
    after: float
    """The same for the final model."""
    floor: Mapping[str, float]
    """Standard deviation of what is left where nothing was flown, SI of the channel."""
    floor_note: str
    """Whether the floor was measured, or stated because the record was filtered before."""
    by_channel: Mapping[str, float]
    by_channel_after: Mapping[str, float]
    by_maneuver: tuple[tuple[int, float, float], ...]
    """Number, gap before, gap after."""
    by_phase: Mapping[str, float]
    """``step edge``, ``plateau``, ``free response``: gap before."""
    by_band_hz: tuple[tuple[float, float, float], ...]
    """From, to, share of the pitch-rate error's power."""


@dataclass(frozen=True, slots=True)
class Cause:
    """One explanation."""

    effect: str
    block: str
    probability: float
    """That this effect is a cause of the gap, or the main one where several are."""
    parameters: Mapping[str, Value]
    cannot_be_told_from: tuple[str, ...]
    tell_apart_by: str
    gap_after: float
    present: bool = False
    """Part of the final model, not just an alternative."""


@dataclass(frozen=True, slots=True)
class Where:
    """The block the gap comes from."""

    block: str
    share: float
    ranking: tuple[tuple[str, float], ...]
    """Block and score, 1 for the best explanation there is."""


@dataclass(frozen=True, slots=True)
class Shrink:
    """How far the gap shrinks on manoeuvres whose numbers were fitted without them.

    Where the air moves, its likeliest course is taken out: it is fitted to the very samples, for no other
    manoeuvre can predict it.
    """

    holdout: tuple[int, ...]
    """Numbers of the manoeuvres kept out."""
    before: float
    after: float
    percent: float
    ci95_percent: tuple[float, float]
    beyond_air_percent: float | None = None
    """Of what each next sample surprises by beyond the noise, with a filter that knows how the air moves:
    what causes other than the air remove, on manoeuvres kept out. Without such a cause: what fitted numbers
    remove of the gap, the air's share left in it. None in still air."""
    by_numbers_percent: float | None = None
    """Where the file's derivatives are wrong besides: what fitted ones remove without any effect. Or None."""


@dataclass(frozen=True, slots=True)
class Unseen:
    """An effect this log could not show, and what it would take."""

    effect: str
    because: str
    would_need: str


@dataclass(frozen=True, slots=True)
class Yardsticks:
    """Accepted measures of fidelity for one channel, on manoeuvres kept out of the fit."""

    theil: float
    """Inequality coefficient, 0 to 1; below 0.25-0.3 is called acceptable."""
    bias: float
    variance: float
    covariance: float
    """Shares of the mean square error, adding to 1."""
    r2: float
    within_tolerance: float | None
    """Share of samples inside the simulator qualification's band; None where it has none."""


@dataclass(frozen=True, slots=True)
class Qualification:
    """One channel of the user's simulator beside the tolerance for qualifying training simulators."""

    channel: str
    limit: float | None
    """14 CFR Part 60, Appendix A, test 2.c.10, SI of the channel; None: none is published."""
    before: float
    """Largest error of the simulator as given, on manoeuvres kept out, SI of the channel."""
    after: float | None
    """Largest error with the effects added to the simulator; None: nothing was added."""
    theil: tuple[float, float | None]
    """Theil's inequality coefficient, before and after."""

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
    """The gap measured in the user's own simulator, on manoeuvres kept out of the fit."""

    simulator: str
    """What the simulator is, for people."""
    before: float
    """Gap of the simulator as given, times the floor's power."""
    after: float | None
    """Gap with the effects added to the simulator; None: nothing was added."""
    percent: float | None
    on_paper: tuple[str, ...]
    """What the simulator cannot be given: effects, ``derivatives``, ``its own servo``."""
    qualification: tuple[Qualification, ...]
    refused: str = ""
    """Why the simulator does not fly with the effects; empty where it does, or none was added."""


@dataclass(frozen=True, slots=True)
class Trace:
    """One channel of one manoeuvre for plotting, at its own stamps."""

    number: int
    channel: str
    t: FloatArray
    measured: FloatArray
    before: FloatArray
    """Simulated by the plain model."""
    after: FloatArray
    """Simulated by the final model."""


@dataclass(frozen=True)
class Diagnosis:
    """The whole answer."""

    verdict: Verdict
    sentence: str
    """For pilots."""
    gap: Gap
    where: Where
    causes: tuple[Cause, ...]
    shrink: Shrink | None
    """None when there was nothing to keep out, or no gap to shrink."""
    waterfall: tuple[tuple[str, float], ...]
    """Effect and gap after adding it."""
    cannot_see: tuple[Unseen, ...]
    kinematics: KinematicCheck
    model: Mapping[str, Value]
    """The eight parameters of the final model at the reference speed."""
    reference_airspeed_m_s: float | None
    """Speed the derivatives belong to: measured, else the file's or what the motion shows; None: unknown."""
    effects: Mapping[str, Mapping[str, float]]
    """What the improved simulator's file has under ``effects``."""
    yardsticks: Mapping[str, tuple[Yardsticks, Yardsticks]]
    """Channel to before and after."""
    share_irreducible: float
    """Of what the final model leaves, the part that is noise and air; the rest is the model's."""
    decisions: tuple[Decision, ...] = ()
    """Every number that was held against a limit, in the order of asking."""
    traces: tuple[Trace, ...] = ()
    notes: tuple[str, ...] = ()
    in_simulator: InSimulator | None = None
    """The gap in the user's own simulator; None where no simulator was named."""
    maneuvers: tuple[int, ...] = field(default=())
    height_m: float | None = None
    """Mean height of the manoeuvres, as recorded; None: not recorded."""


def spelled(effect: str) -> str:
    """An effect's name as people write it."""
    return effect.replace("_", " ")
