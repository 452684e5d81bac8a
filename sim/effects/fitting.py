"""Installation of a scenario's effects in its aircraft."""

from collections.abc import Mapping
from dataclasses import replace

from .. import hangar
from ..autopilot import plan
from ..fittings import Fittings
from ..flight import Flight
from ..loading import ScenarioError
from ..nonlinear_aircraft import NonlinearAircraft
from ..scenario import Scenario
from .catalogue import CATALOGUE
from .kit import Kind, Kit, Sizes
from .outside import OUTSIDE

KINDS: Mapping[str, Kind] = {**CATALOGUE, **OUTSIDE}
"""Every effect that a scenario may name."""


def sizes_of(name: str, given: Sizes) -> dict[str, float]:
    """Return the effect's parameters: the given values, and defaults for the others.

    Raises
    ------
    ScenarioError
        The effect or a parameter is unknown.
    """
    if name not in KINDS:
        raise ScenarioError([f"effects.{name}: unknown effect, choose from {', '.join(KINDS)}"])
    known = KINDS[name].sizes
    wrong = [
        f"effects.{name}.{key}: unknown parameter, choose from {', '.join(known)}"
        for key in given
        if key not in known
    ]
    if wrong:
        raise ScenarioError(wrong)
    return {**known, **given}


def flight_of(scenario: Scenario) -> Flight:
    """Return the flight of a scenario with its effects, trimmed including the effects.

    Raises
    ------
    ScenarioError
        An effect or one of its parameters is unknown, or the aircraft cannot have it.
    """
    problems: list[str] = []
    chosen: list[tuple[Kind, dict[str, float]]] = []
    for name, given in scenario.effects.items():
        try:
            chosen.append((KINDS.get(name) or Kind("", {}), sizes_of(name, given)))
        except ScenarioError as error:
            problems += error.problems
    if problems:
        raise ScenarioError(problems)
    changes: dict[str, float] = {}
    for kind, sizes in chosen:
        if kind.airframe is not None:
            changes.update(kind.airframe(sizes))
    engine = hangar.build(scenario, **changes)
    if not isinstance(engine, NonlinearAircraft):
        problems = [
            f"effects.{name}: needs a nonlinear aircraft (uav or light)"
            for name in scenario.effects
            if KINDS[name].airframe is not None or KINDS[name].nonlinear_only
        ]
        if problems:
            raise ScenarioError(problems)
    usual = hangar.habits(scenario)
    planned = plan(scenario, usual.amplitude_deg, usual.unit_s)
    duration = (planned[-1].end_s if planned else scenario.lead_in_s) + scenario.closing_s
    kit = Kit(
        Fittings(), engine.trim, planned, duration, scenario.seed, scenario.height_m, engine.motion().alpha
    )
    for kind, sizes in chosen:
        if kind.fit is not None:
            kind.fit(kit, sizes)
    return Flight(scenario, kit.fittings, engine)


def without_effects(scenario: Scenario) -> Scenario:
    """Return the scenario without its effects."""
    return replace(scenario, effects={})
