"""Roll and yaw in the analysis: the JSON block ``lateral``, and the text lines on the modes."""

from collections.abc import Iterator
from functools import partial
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import JudgedManeuver, LateralState
from advisor.decision.axes.lateral_requirements import GROUPS, SOURCE
from advisor.model.mil_f_8785c import CATEGORIES, MANNED
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate
from advisor.report.axis_document import concluded, fitted, flown, with_intervals
from advisor.report.qualities import levels_document, levels_of, mode_facts, tests_document, tests_of
from advisor.words.plain import picked, plain

_quality = partial(picked, names="value std ci95")


def lateral_document(state: LateralState, aircraft: Aircraft) -> dict[str, Any]:
    """Return the block ``lateral`` of ``advisor analyze --json``, in SI units."""
    model = state.model
    return {
        "maneuvers": [_maneuver(judged) for judged in state.maneuvers],
        "flight_test": concluded(state.flight_test),
        "model": _model(model),
        "modes": _modes(model) if model else None,
        "levels": levels_document(levels_of(state)),
        "qualification": tests_document(tests_of(state, aircraft)),
        "not_identifiable": dict(model.not_identifiable) if model else {},
        "estimate_from": list(state.estimate_from),
    }


def _maneuver(judged: JudgedManeuver) -> dict[str, Any]:
    estimate = judged.estimate if isinstance(judged.estimate, AxisEstimate) else None
    entry = flown(judged)
    del entry["record_from_boot_s"]
    return {
        **picked(judged.maneuver, "number flight boot mode"),
        **entry,
        **fitted(estimate),
        "estimates": _told(estimate) if estimate else None,
        "modes": _modes(estimate) if estimate else None,
        "not_identifiable": dict(estimate.not_identifiable) if estimate else {},
    }


def _told(estimate: Estimate) -> dict[str, Any]:
    """Return every identifiable derivative with its 95 % interval."""
    return {name: entry for name, entry in with_intervals(estimate).items() if "reason" not in entry}


def _model(model: AxisEstimate | None) -> dict[str, Any] | None:
    if model is None:
        return None
    return {
        **_told(model),
        "reference_airspeed_m_s": plain(model.airspeed_m_s),
        "instruments": {
            name: {"value": plain(value), "std": plain(std)} for name, (value, std) in model.nuisances.items()
        },
    }


def _modes(estimate: AxisEstimate) -> dict[str, Any]:
    modes = estimate.modes
    return {
        "dutch_roll": {
            "omega": _quality(modes.get("dutch_roll_omega")),
            "zeta": _quality(modes.get("dutch_roll_zeta")),
        },
        "roll": {"time_constant": _quality(modes.get("roll_time_constant"))},
        "spiral": {"pole": _quality(modes.get("spiral_pole"))},
        "left_out": dict(estimate.modes_left_out),
    }


def side_quality_lines(state: LateralState, aircraft: Aircraft) -> Iterator[str]:
    """Yield text lines: the modes, the levels for light aircraft, and the tests of the aircraft
    file's model.
    """
    yield from (f"  {fact.name:<18} {fact.sentence}" for fact in mode_facts(state))
    levels = [level for level in levels_of(state) if level.group == next(iter(GROUPS))]
    if levels:
        yield f"  {SOURCE}, Classes {levels[0].group}:"
        yield from (f"    {level.governing.sentence} ({CATEGORIES[level.category]})" for level in levels)
        yield f"  {MANNED}"
    for t in tests_of(state, aircraft):
        mark = "✓" if t.holds else "✗"
        yield (
            f"  {mark} {t.name}: flown {t.flown:.3g}, simulator {t.simulated:.3g} {t.unit}".rstrip()
            + f" (14 CFR Part 60 {t.entry}: ± {t.limit:.2g})"
        )
