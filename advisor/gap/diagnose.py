"""The diagnosis: where the gap lies, which effect causes it, how far it shrinks without it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from advisor.aircraft import Aircraft
from advisor.flight.kinematics import KinematicCheck, check_alpha, combine
from advisor.flight.maneuver import Maneuver
from advisor.gap.explain import evidence_of_one_maneuver, explain
from advisor.gap.fitting.prior_speed import prior_speed
from advisor.gap.records.airspeed import measures_speed
from advisor.gap.records.flights import Flights
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_speed import speed_of_the_motion
from advisor.gap.records.usable import usable_of
from advisor.gap.result import Diagnosis
from advisor.gap.search.acceptance import LEAST_OFFSET_RAD, OFFSET_SIGMAS
from advisor.gap.search.baseline import at_another_speed, fit_baseline
from advisor.gap.search.stage import added_in
from advisor.gap.search.waterfall import Progress
from advisor.gap.uncatalogued.airspeed_scale import airspeed_scale_of, true_over_read
from advisor.gap.uncatalogued.unexplained import Unexplained, as_wind
from advisor.gap.uncatalogued.weight_check import WeightReading, weight_reading
from advisor.gap.uncatalogued.wind_shear import moves_along_path, wind_shear
from advisor.gap.verdict.answer import answer
from advisor.gap.verdict.evidence import Evidence
from advisor.gap.verdict.notes import left_out
from advisor.problems import UnusableInputError


@dataclass(frozen=True)
class Examined:
    """A diagnosis with what it was made from."""

    diagnosis: Diagnosis
    evidence: Evidence


def diagnose(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    holdout: int | None = None,
    progress: Progress = lambda *_: None,
) -> Diagnosis:
    """Diagnose the sim-to-real gap from flown manoeuvres.

    Parameters
    ----------
    maneuvers
        As the segmenter found them, with elevator, α and pitch rate. A single one tells where the gap lies,
        not its cause: none is left to keep out of the fit.
    aircraft
        The aircraft file: what the simulator believes today.
    holdout
        How many manoeuvres, the last ones, the shrink is measured on, with every number fitted without them
        (which effects are there is judged on all); None: all, each kept out in turn with a third of them.
    progress
        Called with a sentence and the share done.

    Raises
    ------
    UnusableInputError
        No usable manoeuvre, or no angle of attack.
    """
    return examine(maneuvers, aircraft, holdout, progress).diagnosis


def examine(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    holdout: int | None = None,
    progress: Progress = lambda *_: None,
) -> Examined:
    """Diagnose as ``diagnose`` does, and keep the evidence for a simulator that flies the answer.

    Raises
    ------
    UnusableInputError
        No usable manoeuvre, or no angle of attack.
    """
    progress("checking the angle of attack against the motion", 0.0)
    aircraft = _with_speed(usable_of(maneuvers), aircraft)
    offset = aircraft.effects.get("alpha_bias", {}).get("bias_rad", 0.0)
    maneuvers = [_without_offset(m, offset) for m in maneuvers]
    evidence, kinematics = _explained(maneuvers, aircraft, progress)
    progress("measuring the gap", 0.9)
    diagnosis = answer(evidence, aircraft, kinematics, holdout)
    used = {flight.number for flight in evidence.problem.flights.flights}
    missing = left_out([m for m in maneuvers if m.number not in used])
    return Examined(replace(diagnosis, notes=(*diagnosis.notes, *missing)), evidence)


def _explained(
    maneuvers: Sequence[Maneuver], aircraft: Aircraft, progress: Progress
) -> tuple[Evidence, KinematicCheck]:
    """What the manoeuvres tell, and the check of α without aerodynamics."""
    flights = prepare(maneuvers, aircraft)
    _refuse(flights)
    arms = aircraft.accelerometer.arm_m, aircraft.alpha.vane_arm_m
    numbers = {flight.number for flight in flights.flights}
    flown = [_without_dead_pitot(m) for m in maneuvers if m.number in numbers]
    kinematics = combine([check_alpha(m, aircraft.stated_airspeed_m_s, *arms) for m in flown])
    progress("fitting the simulator's model", 0.1)
    least = max(LEAST_OFFSET_RAD, OFFSET_SIGMAS * kinematics.offset.std_rad)
    if kinematics.offset.stays and abs(kinematics.offset.rad) > least:
        # What the climb rate shows is taken out first, else the trim would carry it into the lift.
        maneuvers = [_without_offset(m, kinematics.offset.rad) for m in maneuvers]
        flights = prepare(maneuvers, aircraft)
    problem, baseline = fit_baseline(flights, aircraft)
    speed = None if aircraft.reference_airspeed_m_s else prior_speed(problem, baseline)
    if speed is not None:
        aircraft = replace(aircraft, reference_airspeed_m_s=speed)
        flights = prepare(maneuvers, aircraft)
        problem, baseline = at_another_speed(problem, baseline, flights)
    weight = weight_reading(flown, flights.reference_m_s)
    over_read = true_over_read(airspeed_scale_of(problem, baseline), weight)
    if over_read > 1.0:
        # An indicated air speed changes by less than the accelerometers say.
        flights = prepare(maneuvers, aircraft, over_read)
        problem, baseline = at_another_speed(problem, baseline, flights)
    if len(flights) == 1:
        return evidence_of_one_maneuver(problem, baseline), kinematics
    return _checked_against_path(explain(problem, baseline, aircraft, progress), flown, weight), kinematics


def _refuse(flights: Flights) -> None:
    if not len(flights):
        raise UnusableInputError(
            "no_maneuver",
            "No usable manoeuvre in the log: no simulator can be held against it.",
            "Fly at least three elevator manoeuvres (3-2-1-1 or doublets), better nine.",
        )
    if "alpha" not in flights.channels:
        raise UnusableInputError(
            "no_alpha",
            "No angle of attack in the log.",
            "Log AOA_SSA, or set alpha.source in the aircraft file.",
        )


def _without_dead_pitot(maneuver: Maneuver) -> Maneuver:
    """The manoeuvre without an air speed that stands still in flight."""
    if measures_speed(maneuver):
        return maneuver
    return replace(maneuver, channels={k: c for k, c in maneuver.channels.items() if k != "airspeed"})


def _with_speed(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Aircraft:
    """The aircraft with the speed that its motion shows, where neither file nor every manoeuvre has one."""
    if aircraft.stated_airspeed_m_s or all(measures_speed(m) for m in maneuvers):
        return aircraft
    return replace(aircraft, airspeed_m_s=speed_of_the_motion(maneuvers))


def _without_offset(maneuver: Maneuver, offset: float) -> Maneuver:
    """The manoeuvre with a constant taken off its angle of attack."""
    channels = dict(maneuver.channels)
    if "alpha" in channels:
        channels["alpha"] = replace(channels["alpha"], y=channels["alpha"].y - offset)
    return replace(maneuver, channels=channels)


def _checked_against_path(e: Evidence, flown: Sequence[Maneuver], weight: WeightReading | None) -> Evidence:
    """What air speed and accelerometer are off by beside the path, without any aerodynamics."""
    shear = wind_shear(flown, true_over_read(e.airspeed_scale, weight))
    of_gusts = shear is not None and shear.is_implausible and e.air is not None
    if shear is not None and not of_gusts and not _mimics_wind(e.unexplained):
        # Air that moves swings the air speed, too: beside it what is not plain is worth a note, no more.
        is_there = e.air is None or shear.exceeds_gusts
        e = replace(e, shear=shear, unexplained=as_wind(e.unexplained) if is_there else e.unexplained)
    if e.unexplained is not None and e.unexplained.block == "force_equation" and moves_along_path(flown):
        # A wind that changes is felt as lift that comes and goes.
        e = replace(e, unexplained=as_wind(e.unexplained))
    is_off = weight is not None and weight.is_off
    # What an accelerometer reads wrong looks like a force, too: a name for one is no other explanation.
    elsewhere = any(j.block != "force_equation" for j in added_in(e.stages))
    is_scaled = e.airspeed_scale is not None and e.airspeed_scale.is_the_accelerometers(weight)
    if e.unexplained is None and (is_scaled or (is_off and not elsewhere) or _reads_another_speed(e, weight)):
        e = replace(e, unexplained=Unexplained("accelerometer", 1.0, (("accelerometer", 1.0),)))
    return replace(e, weight=weight if is_off else None)


def _reads_another_speed(e: Evidence, weight: WeightReading | None) -> bool:
    """Whether air speed and accelerometer are too far apart for any air speed, and nothing else was named."""
    # A gust moves α by more than its filter knows, and by as much what the motion says of the speed.
    alone = len(e.stages) == 1 and not (e.air is not None and e.air.gust)
    return alone and e.airspeed_scale is not None and e.airspeed_scale.is_wrong(e.air is not None, weight)


def _mimics_wind(unexplained: Unexplained | None) -> bool:
    """An attitude that is wrong, or an accelerometer by a law that is known: the climb, or the speed along
    the path, is computed from it, and parts from the air speed as in a wind that changes with height."""
    if unexplained is None:
        return False
    return unexplained.block == "attitude_sensor" or (
        unexplained.block == "accelerometer" and unexplained.note != ""
    )
