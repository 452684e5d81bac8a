"""Levels and tolerances of roll and yaw: for the document and as rows for people."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.campaign.state import JudgedLateral, LateralState
from advisor.decision.lateral_levels import GROUPS, SOURCE, LateralLevels, lateral_levels
from advisor.decision.lateral_qualification import LateralTest, lateral_qualification
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.lateral import Trim
from advisor.model.mil_f_8785c import CATEGORIES, MANNED
from advisor.oem.flying_qualities import Quality
from advisor.oem.lateral_estimate import LateralModes
from advisor.words.plain import picked

MODES: Mapping[str, tuple[str, str]] = {
    "dutch_roll_omega": ("Dutch roll ω", "rad/s"),
    "dutch_roll_zeta": ("Dutch roll ζ", ""),
    "roll_time_constant": ("roll time constant", "s"),
    "spiral_pole": ("spiral pole", "1/s"),
}
"""Field of `LateralModes` to its name for people and its unit."""
NAMES = {"dutch_roll": "Dutch roll", "roll": "roll", "spiral": "spiral"}
OPTIONAL = frozenset({"Y_p", "Y_r", "Y_delta_a"})
"""Derivatives that count as zero where the aircraft file states the others: a few per cent everywhere."""


def modes_told(modes: LateralModes) -> dict[str, Quality]:
    """Return the modes that the estimate tells, by the names of ``MODES``."""
    return {name: one for name in MODES if (one := getattr(modes, name)) is not None}


def levels_of(state: LateralState) -> tuple[LateralLevels, ...]:
    """Return the levels of the joint estimate; empty without one."""
    return lateral_levels(state.model.modes) if state.model is not None else ()


def levels_document(found: tuple[LateralLevels, ...]) -> dict[str, Any] | None:
    """Return the part ``levels`` of the block ``lateral``; None without a level."""
    if not found:
        return None
    by_class: dict[str, dict[str, Any]] = {group: {} for group in GROUPS}
    for one in found:
        by_class[one.group][one.category] = {
            "level": one.governing.level,
            "levels_within_ci95": [one.governing.best_level, one.governing.worst_level],
            "phases": CATEGORIES[one.category],
            "by_mode": {
                mode: {"level": level.level, "levels_within_ci95": [level.best_level, level.worst_level]}
                for mode, level in one.by_mode.items()
            },
            "text": one.governing.sentence,
        }
    return {"by_class": by_class, "source": SOURCE, "caution": MANNED}


def tests_of(state: LateralState, aircraft: Aircraft) -> tuple[LateralTest, ...]:
    """Return the tests of the aircraft file's model against the joint estimate; empty without either.

    The file must state every derivative but those of ``OPTIONAL``.
    """
    model = state.model
    stated = {name: aircraft.model[name] for name in SIDE_PARAMETERS if name in aircraft.model}
    if model is None or not {*stated, *OPTIONAL} >= set(SIDE_PARAMETERS):
        return ()
    joined = [one for one in state.maneuvers if one.maneuver.number in state.estimate_from]
    rolled = [one for one in joined if one.maneuver.span.kind.startswith(("aileron", "bank"))]
    tests = lateral_qualification(
        model.estimate.theta,
        np.array([stated.get(name, 0.0) for name in SIDE_PARAMETERS]),
        trim_of([one.maneuver for one in joined], model.estimate.airspeed_m_s or np.nan),
        *_step(rolled),
    )
    if rolled and "L_delta_a" not in model.estimate.not_identifiable:
        return tests
    return tuple(one for one in tests if one.entry != "2.d.2")


def tests_document(tests: tuple[LateralTest, ...]) -> list[dict[str, Any]]:
    """Return the list ``qualification`` of the block ``lateral``."""
    return [picked(one, "entry name unit flown simulated limit holds") for one in tests]


def trim_of(joined: Sequence[Maneuver], airspeed_m_s: float) -> Trim:
    """Return the mean attitude of the manoeuvres; level flight where no angle of attack was recorded."""
    theta = _mean(joined, "theta", 0.0)
    return Trim(airspeed_m_s, _mean(joined, "alpha", theta), theta)


def _mean(joined: Sequence[Maneuver], name: str, otherwise: float) -> float:
    found = [one.channels[name].y for one in joined if name in one.channels]
    return float(np.mean([np.mean(y) for y in found])) if found else otherwise


def _step(rolled: list[JudgedLateral]) -> tuple[float, float]:
    """Return size and length of the largest step of the aileron that was flown, rad and s."""
    steps = [
        (abs(level), after - onset)
        for one in rolled
        for (onset, level), (after, _) in pairwise(one.maneuver.span.steps)
    ]
    return max(steps, default=(0.0, 1.0))
