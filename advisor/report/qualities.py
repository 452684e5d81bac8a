"""Flying qualities and coefficients of a campaign: for the documents, and as lines for people."""

from collections.abc import Iterator, Mapping
from typing import Any

from advisor.aircraft.reference import Reference
from advisor.campaign.state import CampaignState
from advisor.flight.instruments.atmosphere import AirData, air_flown
from advisor.model.mil_f_8785c import CATEGORIES, MANNED, SOURCE
from advisor.oem.coefficients import CONVENTION, Coefficient, coefficients
from advisor.oem.flying_qualities import UNITS, FlyingQualities, flying_qualities
from advisor.words.digits import with_half
from advisor.words.plain import picked
from advisor.words.quantiles import NORMAL_95

NAMES: Mapping[str, str] = {
    "natural_frequency": "short period ω_n",
    "damping": "short period ζ",
    "t_theta_2": "T_θ2",
    "n_alpha": "n/α",
    "cap": "CAP = ω_n²/(n/α)",
    "static_margin": "static margin",
    "neutral_point": "neutral point",
}
"""Quality to its name for people."""


def qualities_of(state: CampaignState, reference: Reference) -> FlyingQualities | None:
    """Return flying qualities of the joint estimate; None without an estimate."""
    return None if state.model is None else flying_qualities(state.model, _air(state, reference), reference)


def coefficients_of(state: CampaignState, reference: Reference) -> Mapping[str, Coefficient]:
    """Return the non-dimensional coefficients of the joint estimate; empty without an estimate."""
    return {} if state.model is None else coefficients(state.model, reference, _air(state, reference))


def _air(state: CampaignState, reference: Reference) -> AirData:
    joined = set(state.estimate_from)
    flown = [j.maneuver for j in state.maneuvers if j.maneuver.number in joined]
    return air_flown(flown, reference.air_temperature_c)


def reference_speed(state: CampaignState) -> str:
    """Return the speed of the derivatives for a heading, with its kind; empty without a speed."""
    if state.model is None or state.model.airspeed_m_s is None:
        return ""
    kind = " true" if _air(state, Reference()).speed_kind == "true" else ""
    return f" at {state.model.airspeed_m_s:.1f} m/s{kind}"


def qualities_document(found: FlyingQualities | None) -> dict[str, Any] | None:
    """Return the part ``flying_qualities`` of ``advisor.analyze/1``. Each number has its unit."""
    if found is None:
        return None
    return {
        **{
            name: {**picked(one, "value std ci95"), "unit": UNITS[name]}
            for name, one in found.qualities.items()
        },
        "correlation": found.correlation,
        "left_out": dict(found.left_out),
        "levels": {
            one.category: {
                "level": one.level,
                "levels_within_ci95": [one.best_level, one.worst_level],
                "phases": CATEGORIES[one.category],
                "text": one.sentence,
            }
            for one in found.levels
        },
        "source": SOURCE,
        "caution": MANNED,
        "air": {
            "density_kg_m3": found.air.density_kg_m3,
            "density_from": found.air.source,
            "airspeed_m_s": found.airspeed_m_s,
            "airspeed_is": found.air.speed_kind,
            "true_airspeed_m_s": found.true_airspeed_m_s,
            "text": found.air.sentence,
        },
        "convention": CONVENTION,
    }


def quality_lines(found: FlyingQualities, coefficients: Mapping[str, Coefficient]) -> Iterator[str]:
    """Yield flying qualities and coefficients, one on each line, with half the 95 % interval."""
    yield f"Flying qualities at {_speeds(found)}:"
    for name, one in found.qualities.items():
        shown = with_half(one.value, NORMAL_95 * one.std)
        yield f"  {NAMES[name]:<17} {shown} {UNITS[name].removesuffix('1')}".rstrip()
    for name, why in found.left_out.items():
        yield f"  {NAMES[name]:<17} not given: {why}"
    if found.levels:
        yield f"  {SOURCE}:"
        yield from (f"    {one.sentence} ({CATEGORIES[one.category]})" for one in found.levels)
        yield f"  {MANNED}"
    if coefficients:
        yield f"Coefficients {CONVENTION}:"
        listed = "  ".join(
            f"{name} {with_half(c.value, NORMAL_95 * c.std)}" for name, c in coefficients.items()
        )
        yield f"  {listed}"
    yield f"note: {found.air.sentence[0].upper()}{found.air.sentence[1:]}."


def _speeds(found: FlyingQualities) -> str:
    if found.airspeed_m_s is None or found.true_airspeed_m_s is None:
        return "an unknown air speed"
    if found.air.speed_kind == "true":
        return f"{found.true_airspeed_m_s:.1f} m/s true"
    return f"{found.airspeed_m_s:.1f} m/s as logged"
