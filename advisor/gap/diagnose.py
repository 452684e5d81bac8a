"""The diagnosis: the place of the gap, the effect that causes it, and the gap's reduction by that effect."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.as_flown import as_flown
from advisor.gap.candidates.known import AIR, left_aside
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.inference.diagnose import Mirror, infer
from advisor.gap.inference.engine import Progress
from advisor.gap.inference.findings import Circumstances, Findings
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.inference.prior_speed import prior_speed
from advisor.gap.records.prepare import prepare
from advisor.gap.result import Cause, Diagnosis, spelled
from advisor.gap.search.baseline import at_another_speed, fit_baseline, of_this_flight
from advisor.gap.uncatalogued.weight_check import airspeed_scale_of, true_over_read, weight_reading
from advisor.gap.verdict.answer import answer_of
from advisor.gap.verdict.notes import left_out
from advisor.gap.verdict.one_maneuver import answer_of_one
from advisor.gap.verdict.text import answers_of
from advisor.words.certainty import as_sure
from advisor.words.quantities import NORMAL_95, decimals_for, with_half


@dataclass(frozen=True)
class Examined:
    """A diagnosis together with the findings that support it."""

    diagnosis: Diagnosis
    findings: Findings
    fewer: "Callable[[int], Examined] | None" = None
    """Function that returns the diagnosis with only the first n effects; None for an answer without an
    effect."""
    seen_in: "Callable[[EffectProblem], Examined] | None" = None
    """Function that returns the diagnosis refitted to other outputs of the flight; None for a single
    manoeuvre."""

    def with_most(self, effects: int) -> "Examined":
        """Return the diagnosis with at most ``effects`` effects, in the order of the answer."""
        return self if self.fewer is None else self.fewer(effects)

    @property
    def named(self) -> tuple[str, ...]:
        """Effects of the answer, in the order of their addition."""
        return tuple(added.effect for added in self.findings.added)


def examine(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    holdout: int | None = None,
    progress: Progress = lambda *_: None,
    prior: FieldPrior = FIELD,
    mirror: Mirror = lambda *_: None,
) -> Examined:
    """Diagnose the sim-to-real gap from flown manoeuvres, with the findings behind the diagnosis.

    Parameters
    ----------
    maneuvers
        Manoeuvres of the segmenter, with elevator, α and pitch rate. A single manoeuvre shows where the gap
        lies. One manoeuvre shows no cause, because no manoeuvre remains for the hold-out.
    holdout
        Number of the last manoeuvres that are held out to measure the shrink of the gap. The parameters are
        fitted without the held-out manoeuvres; the effects are selected on all manoeuvres. None: every
        manoeuvre is held out in turn.
    progress
        Function that receives a sentence and the share of the work that is done, 0 to 1.
    mirror
        Search for effects that only the user's simulator has.

    Raises
    ------
    UnusableInputError
        No usable manoeuvre, or no angle of attack.
    """
    progress("checking the angle of attack against the motion", 0.0)
    flown = as_flown(maneuvers, aircraft)
    maneuvers, kinematics = flown.maneuvers, flown.kinematics
    progress("fitting the simulator's model", 0.01)
    flights = prepare(maneuvers, flown.aircraft)
    numbers = {flight.number for flight in flights.flights}
    given, aircraft = flown.aircraft.effects, of_this_flight(flights, flown.aircraft)
    problem, baseline = fit_baseline(flights, aircraft)
    speed = None if aircraft.reference_airspeed_m_s else prior_speed(problem, baseline)
    if speed is not None:
        aircraft = replace(aircraft, reference_airspeed_m_s=speed)
        flights = prepare(maneuvers, aircraft)
        problem, baseline = at_another_speed(problem, baseline, flights)
    weight = weight_reading(flown.measured)
    over_read = true_over_read(airspeed_scale_of(problem, baseline), weight)
    if over_read > 1.0:
        # An indicated air speed changes by less than the integral of the accelerations.
        flights = prepare(maneuvers, aircraft, over_read)
        problem, baseline = at_another_speed(problem, baseline, flights)
    notes = left_out([m for m in maneuvers if m.number not in numbers])

    def noted(diagnosis: Diagnosis, findings: Findings) -> Examined:
        return Examined(replace(diagnosis, notes=(*diagnosis.notes, *notes)), findings)

    if len(flights) == 1:
        return noted(*answer_of_one(problem, baseline, aircraft, kinematics))
    inference = infer(problem, baseline, aircraft, kinematics, prior, progress, mirror)
    progress("measuring the gap", 0.97)
    aside = left_aside(given, aircraft.effects, () if inference.sought_air.found is None else AIR)
    circumstances = Circumstances(weight, aside, speed is None)
    answer = partial(answer_of, inference, aircraft, kinematics, holdout, circumstances)
    whole = noted(*answer())
    return replace(whole, fewer=lambda most: noted(*answer(most)), seen_in=lambda x: noted(*answer(seen=x)))


_NOT_GIVEN = (
    "The aircraft file holds no complete model to compare with. The flight was compared with a model fitted "
    "to it, which shows effects beyond eight parameters alone."
)
_STATEMENT = (
    "There is no model to compare with, so no gap can be stated. A fit to this flight shows no effect."
)


_KEYS = {
    "actuator_lag": ("elevator", "lag_s", "s"), "transport_delay": ("elevator", "delay_s", "s"),
    "alpha_vane_offset": ("alpha", "vane_arm_m", "m"),
    "accelerometer_offset": ("accelerometer", "arm_m", "m"),
}  # fmt: skip
"""Section and key of the aircraft file that states an effect, with the unit, by the effect's name."""


def _key_said(cause: Cause, aircraft: Aircraft) -> str:
    """Return the sentence about an effect that a key of the aircraft file states; empty for any
    other effect.
    """
    if cause.effect not in _KEYS or len(cause.parameters) != 1:
        return ""
    section, key, unit = _KEYS[cause.effect]
    (size,) = cause.parameters.values()
    stated = getattr(getattr(aircraft, section), key)
    value = (stated or 0.0) + size.value
    half = NORMAL_95 * size.std
    says = "states no" if stated is None else "says"
    given = "" if stated is None else f" {stated:g}"
    return (
        f"Your file {says} {section}.{key}{given}; this flight says {with_half(value, half)} {unit}. "
        f"Change: {section}: {{{key}: {value:.{decimals_for(half)}f}}}."
    )


def without_simulator(diagnosis: Diagnosis, aircraft: Aircraft) -> Diagnosis:
    """Return the diagnosis as a statement about the flight alone, without the claim that there is no gap."""
    notes = (_NOT_GIVEN, *diagnosis.notes)
    first = next((c for c in diagnosis.causes if c.present), None)
    if diagnosis.improves and first is not None and (changed := _key_said(first, aircraft)):
        return replace(diagnosis, sentence=as_sure(changed, answers_of(diagnosis.evidence)), notes=notes)
    if diagnosis.improves and first is not None:
        sizes = ", ".join(
            f"{name} {v.value:.3g} ± {NORMAL_95 * v.std:.2g}" for name, v in first.parameters.items()
        )
        said = f"This flight shows {spelled(first.effect)} ({sizes}) beyond what the aircraft file states."
        return replace(diagnosis, sentence=as_sure(said, answers_of(diagnosis.evidence)), notes=notes)
    if diagnosis.verdict != "none":
        return replace(diagnosis, notes=notes)
    return replace(diagnosis, verdict="untested", sentence=_STATEMENT, notes=notes)
