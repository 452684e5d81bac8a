"""Knowledge of a log about its aircraft, for a script that flies the next inputs."""

from functools import partial
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.log_facts import LogFacts, facts_of
from advisor.analysis.marks_file import LogSeries
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.flight.vehicle.surfaces import Surface
from advisor.scripts.inputs import CONTROLS, Control
from advisor.scripts.table import Source
from advisor.words.problems import UnusableInputError, printable

OF_FILE = "the aircraft file's model"
_LIMITS = ("MIN", "TRIM", "MAX")


def source_of_file(aircraft: Aircraft) -> Source:
    """Return the statements of the aircraft file alone."""
    return Source(dict(aircraft.model), OF_FILE)


def source_of_log(log: Path, aircraft: Aircraft, target_system: int | None = None) -> Source:
    """Return the statements of the aircraft file and of a log: derivatives, safe sizes, controls, limits of
    outputs.

    The derivatives are the file's. If the file has none, the log's accepted manoeuvres give them.

    Raises
    ------
    UnusableInputError
        The log cannot be read, holds no aircraft, or is not ArduPilot's.
    """
    from advisor.mavlink.logs.logs import read_whole_log

    facts = facts_of(read_whole_log(log), aircraft, target_system)
    if facts.vehicle.autopilot != "ardupilot":
        raise UnusableInputError(
            "autopilot",
            f"{printable(log.name)} is a log of {facts.vehicle.autopilot}, and the script is ArduPilot's.",
            "Give a log of the vehicle that flies the script, or no log.",
        )
    state = _campaign(log, aircraft, target_system)
    model, said = dict(aircraft.model), OF_FILE
    if not model:
        model, said = _derivatives(state), f"the estimate of {printable(log.name)}"
    return Source(model, said, _flown(state), _controls(facts), _limits(facts))


def _campaign(log: Path, aircraft: Aircraft, target_system: int | None) -> CampaignState:
    series = LogSeries([log])
    campaign = partial(Campaign, aircraft, target_system, names=series.names, lateral=True)
    flown = series.fed_to(campaign, lambda running, columns: running.feed(columns))
    flown.finish()
    return flown.state


def _derivatives(state: CampaignState) -> dict[str, float]:
    estimates = [state.model, state.lateral.model if state.lateral else None]
    return {name: e.value(name) for e in estimates if e is not None for name in e.names}


def _flown(state: CampaignState) -> dict[Control, float]:
    """Return the largest deflection from trim of each control in accepted manoeuvres, rad."""
    judged = (*state.maneuvers, *(state.lateral.maneuvers if state.lateral else ()))
    accepted = [m for m in judged if m.verdict.accepted]
    largest = {control: max((_moved(m, control) for m in accepted), default=0.0) for control in CONTROLS}
    return {control: moved for control, moved in largest.items() if moved > 0.0}


def _moved(judged: JudgedManeuver, control: Control) -> float:
    """Return the deflection of a control that the manoeuvre's input moves, from its value before, rad."""
    maneuver = judged.maneuver
    channel = maneuver.channels.get(control)
    if channel is None or len(channel) < 2:
        return 0.0
    before = channel.cut(maneuver.span.record_from_s, maneuver.span.start_s).y
    trim = float(np.median(before)) if len(before) else float(channel.y[0])
    flown = channel.cut(maneuver.span.start_s, maneuver.span.end_s).y
    # One wild pulse is no size: the second largest counts.
    return float(np.sort(np.abs(flown - trim))[-2:][0]) if len(flown) else 0.0


def _controls(facts: LogFacts) -> tuple[Control, ...]:
    """Return the controls that the log's parameters or the aircraft file name; all where nothing is named."""
    named = {name: isinstance(facts.sides.get(name), Surface) for name in ("aileron", "rudder")}
    named["elevator"] = isinstance(facts.elevator, Surface)
    if not facts.wiring.roles or not any(named.values()):
        return CONTROLS
    return tuple(control for control in CONTROLS if named[control])


def _limits(facts: LogFacts) -> dict[str, float]:
    """Return SERVOn_MIN, TRIM, MAX and REVERSED of the controls' outputs, as far as the log states them."""
    surfaces = [facts.elevator, *facts.sides.values()]
    outputs = sorted({n for surface in surfaces if isinstance(surface, Surface) for n in surface.outputs})
    stated: dict[str, float] = {}
    for n in outputs:
        if n in facts.wiring.scales and n not in facts.wiring.doubts:
            scale = facts.wiring.scales[n]
            for name, value in zip(_LIMITS, (scale.low_us, scale.trim_us, scale.high_us), strict=True):
                stated[f"SERVO{n}_{name}"] = value
        if n in facts.wiring.known_directions:
            stated[f"SERVO{n}_REVERSED"] = float(facts.wiring.scale(n).reversed)
    return stated
