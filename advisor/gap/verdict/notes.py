"""What a reader should know beside the answer: what was assumed, missing, unusual, or could not be done."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from advisor.aircraft import Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.gap.candidates.known import Effects, left_aside
from advisor.gap.records.usable import why_left_out
from advisor.gap.result import Verdict, spelled
from advisor.gap.search.work import mean_speed
from advisor.gap.verdict.evidence import Evidence
from advisor.gap.verdict.text import place

_ANOTHER_SPEED = 0.005
"""Relative: by less two ways of taking the mean differ."""


def notes_of(
    e: Evidence, aircraft: Aircraft, holdout: int | None, verdict: Verdict, nobodys_fault: Collection[str]
) -> tuple[str, ...]:
    """Every note that these flights and their aircraft file call for, a sentence each.

    ``nobodys_fault`` are effects that the improved simulator gets though they are no cause.
    """
    notes = []
    flights = e.problem.flights
    if holdout is not None and holdout >= len(flights):
        notes.append(
            f"{holdout} manoeuvres cannot be kept out of {len(flights)}: each was kept out in turn instead. "
            f"Keep out {len(flights) - 1} at most."
        )
    notes.append(_command(e))
    if not flights.speed_measured:
        shown = "a_x" in flights.has and {"alpha", "a_z", "theta"} <= set(flights.channels)
        from_there = "from there it is what the accelerometers make of it" if shown else "it stays there"
        whence = (
            "from the aircraft file, or from the motion where the file has none"
            if aircraft.stated_airspeed_m_s
            else "assumed"
        )
        apart = flights.speed_moves > 0.0
        level = "on average" if apart else "before each manoeuvre"
        differs = f", up to {100.0 * flights.speed_moves:.0f} % off by the motion" if apart else ""
        notes.append(
            f"No air speed in the log: {flights.reference_m_s:.1f} m/s {level}, {whence}{differs}; "
            f"{from_there}."
        )
    flown, reference = mean_speed(flights), flights.reference_m_s
    is_stated = aircraft.reference_airspeed_m_s is not None
    if flights.speed_measured and not is_stated and abs(reference / flown - 1.0) > _ANOTHER_SPEED:
        notes.append(
            f"The aircraft file's numbers are right at {reference:.1f} m/s; the manoeuvres' mean is "
            f"{flown:.1f}: state reference_airspeed_m_s."
        )
    if e.shear is not None:
        per_metre = f"{abs(e.shear.gradient_per_s):.2f} ± {e.shear.std:.2f} m/s"
        notes.append(
            f"The air speed's error grows by {per_metre} a metre climbed: more than any wind changes."
            if e.shear.is_feigned
            else f"The wind changed with height, by {per_metre} a metre."
        )
    if e.true_speed is not None:
        notes.append(e.true_speed.sentence)
    if e.weight is not None:
        notes.append(e.weight.sentence)
    if e.leftover is not None and e.leftover.note:
        notes.append(f"Unexplained {place(e.leftover.block)}: {e.leftover.note}")
    if e.leftover is not None and verdict == "parameters":
        notes.append(f"Beside the wrong numbers something small {place(e.leftover.block)} stays unexplained.")
    for judged in (stage.added for stage in e.stages):
        if judged is not None and judged.witness is not None:
            number = flights.flights[judged.witness].number
            notes.append(
                f"Manoeuvre {number} alone shows the {spelled(judged.effect)}: "
                "it is measured there, and no other manoeuvre could confirm it."
            )
    if e.air is not None:
        notes.append(
            "What is given as 'after' includes this flight's gusts as estimated from the same samples: that "
            "flatters the model, and no aircraft file can hold them."
        )
        if e.air.gust:
            notes.append(f"The gust shows most in manoeuvre {e.air.gust_number}.")
        if flights.alpha_is_derived:
            notes.append(
                "The angle of attack is an estimate that sees no gust: this flight's derivatives are rough, "
                "and the strength of the gusts is overestimated."
            )
    if nobodys_fault:
        notes.append(
            f"The improved simulator has a propeller's terms, too ({_listed(sorted(nobodys_fault))}): "
            "every aircraft with a propeller has them, and they are not counted as a cause."
        )
    notes += _known(aircraft.effects)
    missing = [c for c in ("a_z", "theta") if c not in flights.channels]
    if missing:
        notes.append(f"Without {' and '.join(missing)} several instrument effects cannot be seen.")
    if len(flights) < 6:
        notes.append(
            f"Only {len(flights)} manoeuvres: intervals are wide, changes between manoeuvres hard to see."
        )
    notes += unusual_signs(aircraft.model)
    if aircraft.elevator.lag_s is None:
        notes.append(
            "The servo's lag is not in the aircraft file: a lag found here may simply be the servo's."
        )
    return tuple(notes)


def _command(e: Evidence) -> str:
    """How the command was taken to move between its stamps, and what looks the same."""
    if not e.problem.held:
        return "The command was taken as linear between its stamps, its edges anywhere between two."
    half = 0.5 * float(np.median(np.diff(e.problem.flights.flights[0].t_u)))
    return (
        "The command was held between its stamps. Had it moved linearly instead, the aircraft would answer "
        f"{1e3 * half:.0f} ms late: the two look the same."
    )


def left_out(maneuvers: Sequence[Maneuver], torn: int | None) -> tuple[str, ...]:
    """Which manoeuvres were not used, and why; ``torn`` is the one in which a change came."""
    why = [
        f"manoeuvre {m.number}: "
        + ("the change came while it was flown" if m.number == torn else why_left_out(m))
        for m in maneuvers
    ]
    return tuple(f"Left out: {reason}." for reason in why)


def _known(effects: Effects) -> list[str]:
    """What was made of the effects that stand in the aircraft file."""
    aside = left_aside(effects)
    notes = []
    if had := [effect for effect in effects if effect not in aside]:
        notes.append(f"The simulator has the file's {_listed(had)}; what is found here is beyond that.")
    if aside:
        notes.append(f"The file's {_listed(aside)} belongs to the flight that showed it: left aside.")
    return notes


def _listed(effects: Sequence[str]) -> str:
    return ", ".join(map(spelled, effects))


def unusual_signs(model: Mapping[str, float]) -> tuple[str, ...]:
    """What of an aircraft file's model is right for few aircraft only."""
    if model.get("M_delta_e", 0.0) <= 0.0:
        return ()
    return (
        f"The aircraft file's M_delta_e is {model['M_delta_e']:g}, above zero: unusual, for an elevator is "
        "positive trailing edge down and pitches the nose down; right for a canard.",
    )
