"""Flying qualities of both axes, and coefficients, for documents and for text."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS, Reference
from advisor.campaign.state import CampaignState, JudgedManeuver, LateralState
from advisor.decision.axes.lateral_requirements import (
    GROUPS,
    LateralLevels,
    LateralTest,
    lateral_levels,
    lateral_qualification,
)
from advisor.decision.axes.lateral_requirements import SOURCE as LATERAL_SOURCE
from advisor.flight.instruments.atmosphere import AirData, air_flown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import Trim
from advisor.model.mil_f_8785c import CATEGORIES, MANNED, SOURCE, LevelFound
from advisor.oem.coefficients import CONVENTION, Coefficient, coefficients
from advisor.oem.flying_qualities import UNITS, FlyingQualities, flying_qualities
from advisor.report.facts.estimates import Fact, fact_of, joint_source
from advisor.words.plain import picked

NAMES: Mapping[str, str] = {
    "natural_frequency": "short period ω_n",
    "damping": "short period ζ",
    "t_theta_2": "T_θ2",
    "n_alpha": "n/α",
    "cap": "CAP = ω_n²/(n/α)",
    "static_margin": "static margin",
    "neutral_point": "neutral point",
}
"""Name of each quality for people."""


def qualities_of(state: CampaignState, reference: Reference) -> FlyingQualities | None:
    """Return the flying qualities of the joint estimate; None without an estimate."""
    return None if state.model is None else flying_qualities(state.model, _air(state, reference), reference)


def coefficients_of(state: CampaignState, reference: Reference) -> Mapping[str, Coefficient]:
    """Return the non-dimensional coefficients of the joint estimate; empty without an estimate."""
    return {} if state.model is None else coefficients(state.model, reference, _air(state, reference))


def _air(state: CampaignState | LateralState, reference: Reference) -> AirData:
    joined = set(state.estimate_from)
    flown = [j.maneuver for j in state.maneuvers if j.maneuver.number in joined]
    return air_flown(flown, reference.air_temperature_c)


def reference_speed(state: CampaignState | LateralState) -> str:
    """Return the text of the air speed of an axis's derivatives and its kind, for a heading; empty without a
    speed.
    """
    if state.model is None or state.model.airspeed_m_s is None:
        return ""
    kind = "true" if _air(state, Reference()).speed_kind == "true" else "as logged"
    return f" at {state.model.airspeed_m_s:.1f} m/s {kind}"


def qualities_document(flown: FlyingQualities | None) -> dict[str, Any] | None:
    """Return the document part ``flying_qualities`` of ``advisor.analyze/1``. Each quality is given with its
    unit."""
    if flown is None:
        return None
    return {
        **{
            name: {**picked(quality, "value std ci95"), "unit": UNITS[name]}
            for name, quality in flown.qualities.items()
        },
        "correlation": flown.correlation,
        "left_out": dict(flown.left_out),
        "levels": {
            x.category: {**level_document(x), "phases": CATEGORIES[x.category], "text": x.sentence}
            for x in flown.levels
        },
        "source": SOURCE,
        "caution": MANNED,
        "air": {
            "density_kg_m3": flown.air.density_kg_m3,
            "density_from": flown.air.source,
            "airspeed_m_s": flown.airspeed_m_s,
            "airspeed_is": flown.air.speed_kind,
            "true_airspeed_m_s": flown.true_airspeed_m_s,
            "text": flown.air.sentence,
        },
        "convention": CONVENTION,
    }


def level_document(level: LevelFound) -> dict[str, Any]:
    """Return a level, and the range of levels within the 95 % interval."""
    return {"level": level.level, "levels_within_ci95": [level.best_level, level.worst_level]}


def quality_lines(flown: FlyingQualities, coefficients: Mapping[str, Coefficient]) -> Iterator[str]:
    """Yield flying qualities and coefficients, one per line, with the 95 % half-width."""
    source = f"Flying qualities at {_speeds(flown)}"
    yield f"{source}:"
    for name, quality in flown.qualities.items():
        fact = fact_of(NAMES[name], source, quality.value, quality.std, UNITS[name])
        yield f"  {fact.name:<17} {fact.sentence}"
    for name, why in flown.left_out.items():
        yield f"  {NAMES[name]:<17} not given: {why}"
    if flown.levels:
        yield f"  {SOURCE}:"
        yield from (f"    {level.sentence} ({CATEGORIES[level.category]})" for level in flown.levels)
        yield f"  {MANNED}"
    if coefficients:
        source = f"Coefficients {CONVENTION}"
        yield f"{source}:"
        each = (fact_of(name, source, c.value, c.std) for name, c in coefficients.items())
        yield f"  {'  '.join(f'{fact.name} {fact.cell}' for fact in each)}"
    yield f"note: {flown.air.sentence[0].upper()}{flown.air.sentence[1:]}."


def _speeds(flown: FlyingQualities) -> str:
    if flown.airspeed_m_s is None or flown.true_airspeed_m_s is None:
        return "an unknown air speed"
    if flown.air.speed_kind == "true":
        return f"{flown.true_airspeed_m_s:.1f} m/s true"
    return f"{flown.airspeed_m_s:.1f} m/s as read"


MODES: Mapping[str, tuple[str, str]] = {
    "dutch_roll_omega": ("Dutch roll ω", "rad/s"),
    "dutch_roll_zeta": ("Dutch roll ζ", ""),
    "roll_time_constant": ("roll time constant", "s"),
    "spiral_pole": ("spiral pole", "1/s"),
}
"""Name and unit for people of each quantity of a mode."""
MODE_NAMES = {"dutch_roll": "Dutch roll", "roll": "roll", "spiral": "spiral"}
OPTIONAL = frozenset({"Y_p", "Y_r", "Y_delta_a"})
"""Derivatives that count as zero if the aircraft file states all other derivatives."""


def mode_facts(state: LateralState) -> list[Fact]:
    """Return frequency, damping, time constant and pole of the modes in the joint estimate."""
    modes, source = state.model.modes if state.model else {}, joint_source(state)
    rows = ((modes[name], named) for name, named in MODES.items() if name in modes)
    return [fact_of(name, source, m.value, m.std, unit) for m, (name, unit) in rows]


def levels_of(state: LateralState) -> tuple[LateralLevels, ...]:
    """Return the levels of the joint estimate; empty without one."""
    return lateral_levels(state.model.modes) if state.model is not None else ()


def levels_document(levels: tuple[LateralLevels, ...]) -> dict[str, Any] | None:
    """Return the document part ``levels`` of the block ``lateral``; None without a level."""
    if not levels:
        return None
    by_class: dict[str, dict[str, Any]] = {group: {} for group in GROUPS}
    for rated in levels:
        by_class[rated.group][rated.category] = {
            **level_document(rated.governing),
            "phases": CATEGORIES[rated.category],
            "by_mode": {mode: level_document(level) for mode, level in rated.by_mode.items()},
            "text": rated.governing.sentence,
        }
    return {"by_class": by_class, "source": LATERAL_SOURCE, "caution": MANNED}


def tests_of(state: LateralState, aircraft: Aircraft) -> tuple[LateralTest, ...]:
    """Return the qualification tests of the file's model against the joint estimate; empty without model or
    estimate.

    The file must state every derivative except those of ``OPTIONAL``.
    """
    model = state.model
    stated = {name: aircraft.model[name] for name in SIDE_PARAMETERS if name in aircraft.model}
    if model is None or not {*stated, *OPTIONAL} >= set(SIDE_PARAMETERS):
        return ()
    joined = [m for m in state.maneuvers if m.maneuver.number in state.estimate_from]
    rolled = [m for m in joined if m.maneuver.span.kind.startswith(("aileron", "bank"))]
    tests = lateral_qualification(
        model.theta,
        np.array([stated.get(name, 0.0) for name in SIDE_PARAMETERS]),
        trim_of([m.maneuver for m in joined], model.airspeed_m_s or np.nan),
        *_step(rolled),
    )
    if rolled and "L_delta_a" not in model.not_identifiable:
        return tests
    return tuple(test for test in tests if test.entry != "2.d.2")


def tests_document(tests: tuple[LateralTest, ...]) -> list[dict[str, Any]]:
    """Return the list ``qualification`` of the block ``lateral``."""
    return [picked(test, "entry name unit flown simulated limit holds") for test in tests]


def trim_of(joined: Sequence[Maneuver], airspeed_m_s: float) -> Trim:
    """Return the mean attitude of the manoeuvres. Without an angle of attack, return level flight."""
    theta = _mean(joined, "theta", 0.0)
    return Trim(airspeed_m_s, _mean(joined, "alpha", theta), theta)


def _mean(joined: Sequence[Maneuver], name: str, otherwise: float) -> float:
    series = [m.channels[name].y for m in joined if name in m.channels]
    return float(np.mean([np.mean(y) for y in series])) if series else otherwise


def _step(rolled: list[JudgedManeuver]) -> tuple[float, float]:
    """Return the size, rad, and the duration, s, of the largest aileron step that was flown."""
    steps = [
        (abs(level), after - onset)
        for m in rolled
        for (onset, level), (after, _) in pairwise(m.maneuver.span.steps)
    ]
    return max(steps, default=(0.0, 1.0))


def side_quality_lines(state: LateralState, aircraft: Aircraft) -> Iterator[str]:
    """Yield text lines: the modes, the levels for light aircraft, and the tests of the aircraft
    file's model.
    """
    yield from (f"  {fact.name:<18} {fact.sentence}" for fact in mode_facts(state))
    levels = [level for level in levels_of(state) if level.group == next(iter(GROUPS))]
    if levels:
        yield f"  {LATERAL_SOURCE}, Classes {levels[0].group}:"
        yield from (f"    {level.governing.sentence} ({CATEGORIES[level.category]})" for level in levels)
        yield f"  {MANNED}"
    for t in tests_of(state, aircraft):
        mark = "✓" if t.holds else "✗"
        yield (
            f"  {mark} {t.name}: flown {t.flown:.3g}, simulator {t.simulated:.3g} {t.unit}".rstrip()
            + f" (14 CFR Part 60 {t.entry}: ± {t.limit:.2g})"
        )
