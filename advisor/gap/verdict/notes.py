"""Notes on a diagnosis: assumptions, missing channels, unusual values, and manoeuvres left out."""

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.inference.findings import Findings
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.records.usable import why_left_out
from advisor.gap.result import GapVerdict, spelled
from advisor.gap.simulator.layout import SPEED
from advisor.gap.verdict.text import place

_ANOTHER_SPEED = 0.005
"""Words: least relative difference between two mean air speeds that is reported."""
_MATTERS = 0.3
"""Words: least gap of a constant-speed simulator that is reported."""
UNEXPLAINED = "Unexplained"
"""First word of the note on the law that describes an effect without a name."""
_FEW = 6
"""Words: number of manoeuvres below which changes between them are hardly visible."""


def notes_of(
    e: Findings, aircraft: Aircraft, holdout: int | None, verdict: GapVerdict, nuisances: Collection[str]
) -> tuple[str, ...]:
    """Return all notes on these flights and their aircraft file, one sentence each.

    ``nuisances`` are effects in the improved simulator that are no cause.
    """
    return (
        *_of_the_hold_out(holdout, len(e.problem.flights)),
        _command(e),
        *_of_the_speed(e, aircraft),
        *_of_a_constant_speed(e, verdict),
        *_of_the_unexplained(e),
        *_of_single_witnesses(e),
        *_of_the_air(e),
        *_of_the_file(e, aircraft, nuisances),
        *_of_what_is_missing(e, aircraft),
    )


def _of_the_hold_out(holdout: int | None, flown: int) -> Iterator[str]:
    if holdout is not None and holdout >= flown:
        yield (
            f"{holdout} manoeuvres cannot be held out of {flown}: each was held out in turn instead. "
            f"Give --holdout {flown - 1} at most."
        )


def _of_the_speed(e: Findings, aircraft: Aircraft) -> Iterator[str]:
    """Yield notes on the source of the air speed and its errors."""
    flights = e.problem.flights
    flown, reference = (
        float(np.mean([x.slow[SPEED].mean() for x in flights.flights])),
        flights.reference_m_s,
    )
    is_stated = aircraft.reference_airspeed_m_s is not None and e.circumstances.speed_is_stated
    if not flights.speed_measured:
        yield _without_air_speed(flights, bool(aircraft.stated_airspeed_m_s))
    elif not is_stated and abs(reference / flown - 1.0) > _ANOTHER_SPEED:
        yield (
            f"The aircraft file's derivatives are right at {reference:.1f} m/s. The mean of the manoeuvres "
            f"is {flown:.1f} m/s: state reference_airspeed_m_s."
        )
    if e.airspeed_scale is not None:
        yield e.airspeed_scale.sentence
    if e.circumstances.weight is not None and e.circumstances.weight.is_off:
        yield e.circumstances.weight.sentence


def _of_a_constant_speed(e: Findings, verdict: GapVerdict) -> Iterator[str]:
    """Yield the gap of a constant-speed simulator, if the verdict is none and the air speed varied."""
    if verdict != "none" or e.constant_speed is None or not e.problem.flights.speed_measured:
        return
    constant, given = (whole_gap(h.mean_square, e.floor) for h in (e.constant_speed, e.last.held_out))
    if constant - given > _MATTERS:
        yield (
            f"The air speed of the log varied by up to {100.0 * e.problem.flights.speed_moves:.0f} %. "
            f"At constant speed the simulator would leave a gap of {constant:.1f}."
        )


def _without_air_speed(flights: PreparedManeuvers, is_known: bool) -> str:
    whence = "from the aircraft file, or from the motion where the file has none" if is_known else "assumed"
    moves = flights.speed_moves > 0.0
    level = "on average" if moves else "before each manoeuvre"
    differs = f", with differences up to {100.0 * flights.speed_moves:.0f} % by the motion" if moves else ""
    shown = "a_x" in flights.has and {"alpha", "a_z", "theta"} <= set(flights.channels)
    later = "its changes come from the accelerometers" if shown else "it stays constant"
    return f"No air speed in the log: {flights.reference_m_s:.1f} m/s {level}, {whence}{differs}; {later}."


def _of_the_unexplained(e: Findings) -> Iterator[str]:
    if e.unexplained is not None and e.unexplained.note:
        yield f"{UNEXPLAINED} {place(e.unexplained.block)}: {e.unexplained.note}"


def _of_single_witnesses(e: Findings) -> Iterator[str]:
    for added in e.added:
        if added.sole_maneuver is not None:
            number = e.problem.flights.flights[added.sole_maneuver].number
            yield (
                f"Manoeuvre {number} alone shows the {spelled(added.effect)}: "
                "no other manoeuvre could confirm its size."
            )


def _of_the_air(e: Findings) -> Iterator[str]:
    if e.air is None:
        return
    if e.air.gust:
        yield f"The gust shows most in manoeuvre {e.air.gust_number}."
    if e.problem.flights.alpha_is_derived:
        yield (
            "The angle of attack is an estimate without gusts. This flight's derivatives are rough, and "
            "the strength of the gusts is overestimated."
        )


def _of_the_file(e: Findings, aircraft: Aircraft, nuisances: Collection[str]) -> Iterator[str]:
    """Yield notes on the improved simulator's additional terms and on the file's effects."""
    if nuisances:
        yield (
            f"The improved simulator also has a propeller's terms ({_listed(sorted(nuisances))}). Every "
            "aircraft with a propeller has them, so they do not count as a cause."
        )
    aside = e.circumstances.left_aside
    if had := [effect for effect in aircraft.effects if effect not in aside]:
        yield f"The simulator already has {_listed(had)} from the file; sizes found here add to that."
    if aside:
        yield f"The file's {_listed(aside)} belongs to another flight and is not used."


def _of_what_is_missing(e: Findings, aircraft: Aircraft) -> Iterator[str]:
    flights = e.problem.flights
    if "alpha" not in flights.channels:
        yield (
            "No instrument measures the angle of attack. The angle is a state of the model, which pitch "
            "rate, specific force, attitude and air speed determine."
        )
    missing = [c for c in ("a_z", "theta") if c not in flights.channels]
    if missing:
        yield f"Without {' and '.join(missing)} several instrument effects cannot be seen."
    if len(flights) == 1:
        yield "Only one manoeuvre was flown. None can be held out, so no cause is sought."
    elif len(flights) < _FEW:
        yield f"Only {len(flights)} manoeuvres: intervals are wide, and changes in flight are hard to see."
    yield from unusual_signs(aircraft.model)
    if aircraft.elevator.lag_s is None:
        yield "The aircraft file does not state the servo's lag: a lag found here may be the servo's."


def _command(e: Findings) -> str:
    """Return a note on the assumed motion of the command between its stamps."""
    if not e.problem.held:
        return "The command was taken as linear between its stamps. An edge may lie anywhere between them."
    half = 0.5 * float(np.median(np.diff(e.problem.flights.flights[0].t_u)))
    return (
        "The command was taken as constant between its stamps. A linear command with a delay of "
        f"{1e3 * half:.0f} ms looks the same."
    )


def left_out(maneuvers: Sequence[Maneuver]) -> tuple[str, ...]:
    """Return the unused manoeuvres, each with the reason."""
    return tuple(f"Left out: manoeuvre {m.number}: {why_left_out(m)}." for m in maneuvers)


def _listed(effects: Sequence[str]) -> str:
    return ", ".join(map(spelled, effects))


def unusual_signs(model: Mapping[str, float]) -> tuple[str, ...]:
    """Return a note on a sign in the aircraft file's model that is right for few aircraft only."""
    if model.get("M_delta_e", 0.0) <= 0.0:
        return ()
    return (
        f"The aircraft file's M_delta_e is {model['M_delta_e']:g}, above zero. That is right for a canard "
        "only: an elevator trailing edge down is positive and pitches the nose down.",
    )
