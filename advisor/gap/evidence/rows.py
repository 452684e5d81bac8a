"""The rows of the evidence: what was measured, arranged as the same columns for every alternative."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.instruments.kinematics import SMALLEST_LAG_S, SMALLEST_SCALE
from advisor.flight.signals.messages import FloatArray
from advisor.gap.alternative import Alternative, Kind
from advisor.gap.effects import EFFECTS
from advisor.gap.evidence.fits import WEIGHTY, Values, of_fit, of_set
from advisor.gap.evidence.measured import Measured, Residual
from advisor.gap.kit.effect import BLOCKS, Effect
from advisor.gap.noise.probes import DYNAMIC, SENSOR_CHANNELS
from advisor.gap.search.acceptance import LEAST_OFFSET_RAD
from advisor.gap.search.air import LEAST_GUST_ANGLE

UNKNOWN_IN = (*BLOCKS, "attitude_sensor")
"""Blocks in which an effect without a name may lie."""
_KINDS: Mapping[str, Kind] = {"air": "air"}
"""Kind of the effects of a block, where it is not ``effect``."""


@dataclass(frozen=True)
class Row:
    """One alternative with the values of its columns; a column that is left out is zero."""

    alternative: Alternative
    values: Values


def rows_of(m: Measured, answer: Alternative | None = None) -> tuple[Row, ...]:
    """Return one row for each alternative: none, parameters, every effect, every set of two that the search
    found, and every block without a name.

    ``answer`` is the alternative that the search ends with.
    """
    probed = _of_blocks(m)
    strongest = max(probed.values(), key=lambda values: values["block_gain"])
    together = _of_residual(m, m.base) | _of_courses(m, *m.courses) | strongest
    rows = [Row(Alternative("none", "none"), together | _of_the_file(m))]
    if m.has_file:
        numbers = together | _of_the_file(m) | _of_fitted_numbers(m)
        rows.append(Row(Alternative("parameters", "parameters"), numbers))
    screened = _of_screening(m)
    for name, effect in EFFECTS.items():
        values = _of_residual(m, m.base) | probed[_probed_in(effect)] | screened[name]
        values |= of_fit(m, name) | _of_kinematics(m, effect) | _of_air(m, effect)
        values |= _of_courses(m, effect.block) if effect.of_one_flight else {}
        values["estimated"] = float(effect.channel == "alpha" and m.alpha_is_estimated)
        rows.append(Row(stated_as(name), values))
    single = {row.alternative.name: row.values for row in rows}
    # What does not come from the fit is that of the main effect: screening and kinematics try one at a time.
    rows += [Row(stated_as(*names), single[names[0]] | of_set(m, names)) for names in m.sets]
    lead = max(m.laws.values(), default=0.0) - m.named_gain
    for block in UNKNOWN_IN:
        # A free disturbance of the air has a name: turbulence.
        values = _of_residual(m, m.last) | _of_courses(m, block) | ({} if block in _KINDS else probed[block])
        values |= {"law_gain": m.laws.get(block, 0.0), "few_maneuvers": _concentration(m.last), "tried": 1.0}
        values["weight"] = m.weight.get(block, 0.0)
        values |= (
            {"law_lead": lead} if m.laws.get(block, 0.0) == max(m.laws.values(), default=0.0) > 0 else {}
        )
        rows.append(Row(Alternative("unknown", "unknown", block), values))
    return tuple(
        Row(row.alternative, {**row.values, "answer": 1.0}) if row.alternative == answer else row
        for row in rows
    )


def stated_as(effect: str, second: str = "") -> Alternative:
    """Return an effect of the catalogue, or a set of two, as an alternative."""
    block = EFFECTS[effect].block
    return Alternative(_KINDS.get(block, "effect"), effect, block, second)


def _of_residual(m: Measured, residual: Residual) -> Values:
    """Return the misfit that a model leaves, by channel and altogether."""
    misfit = np.maximum(residual.power - 1.0, 0.0)
    by_channel = {f"misfit_{name}": float(x) for name, x in zip(m.channels, misfit, strict=True)}
    return by_channel | {
        "misfit": float(np.max(misfit)),
        "of_peak": 100.0 * float(np.max(residual.of_peak)),
        "activity": float(np.max(residual.activity)),
    }


def _of_blocks(m: Measured) -> dict[str, Values]:
    """Return the free disturbances by block; timing has those of the sensor whose stamps may be off."""
    first, last = (_gains(residual) for residual in (m.base, m.last))
    best, best_left = (max(*gains.values(), WEIGHTY) for gains in (first, last))
    return {
        block: {
            "block_gain": first.get(block, 0.0),
            "block_share": max(first.get(block, 0.0), 0.0) / best,
            "block_left": last.get(block, 0.0),
            "block_left_share": max(last.get(block, 0.0), 0.0) / best_left,
            "block_explains": m.last.probes.get(block, (0.0, 0.0))[1],
        }
        for block in UNKNOWN_IN
    }


def _gains(residual: Residual) -> dict[str, float]:
    gains = {block: gain for block, (gain, _) in residual.probes.items()}
    return gains | {"timing": max((gains.get(block, 0.0) for block in SENSOR_CHANNELS), default=0.0)}


def _probed_in(effect: Effect) -> str:
    """Return the block whose free disturbance resembles the effect: a sensor's for a wrong stamp."""
    if effect.block in DYNAMIC or effect.block in SENSOR_CHANNELS:
        return effect.block
    channel = effect.channel or "q"
    return next(block for block, its in SENSOR_CHANNELS.items() if its == channel)


def _of_screening(m: Measured) -> dict[str, Values]:
    """Return the gains of the screening, absolute and relative to those of other effects."""
    gains = {effect: found.gain for effect, found in m.screened.items()}
    best = max([*gains.values(), WEIGHTY])
    values: dict[str, Values] = {}
    for effect in EFFECTS:
        if effect not in m.screened:
            values[effect] = {}
            continue
        found = m.screened[effect]
        other = max((gain for name, gain in gains.items() if name != effect), default=0.0)
        values[effect] = {
            "tried": 1.0,
            "screen_gain": found.gain,
            "screen_share": max(found.gain, 0.0) / best,
            "screen_lead": (found.gain - max(other, 0.0)) / best,
            "file_agreement": found.file_agreement,
            "size": found.size,
        }
    return values


def _of_kinematics(m: Measured, effect: Effect) -> Values:
    """Return the finding of the kinematics that speaks of the effect.

    An offset shows in the kinematics alone. Its gain is that of a measurement z standard deviations from
    zero, z²/2.
    """
    findings = {
        "offset": (m.offset_rad, LEAST_OFFSET_RAD),
        "lag": (m.lag_s, SMALLEST_LAG_S),
        "scale": (m.scale, SMALLEST_SCALE),
    }
    if effect.kinematics not in findings:
        return {}
    (value, std), smallest = findings[effect.kinematics]
    z, size = abs(value) / max(std, 1e-9), abs(value) / smallest
    found = {"kinematics": z, "kinematic_size": size}
    if effect.name in m.screened or std <= 0.0:
        return found
    gain = 0.5 * z**2
    share = m.offset_gap / max(m.offset_gap + m.base_gap, 1e-9)
    return found | {
        "tried": 1.0, "screen_gain": gain, "screen_share": gain / max(gain + m.named_gain, WEIGHTY),
        "fit_gain": gain, "fit_share": gain / max(gain + m.named_gain, WEIGHTY),
        "size": size, "size_sigmas": z, "gap_removed": share, "model_share": share,
    }  # fmt: skip


def _of_air(m: Measured, effect: Effect) -> Values:
    """Return the moving air, for the effects of the air."""
    if effect.block != "air" or "alpha" not in m.channels:
        return {}
    once = 1.0 if effect.comes_once else -1.0
    shape = 0.0 if m.air_is_gust is None else 1.0 if m.air_is_gust else -1.0
    share = m.air_gain / max(m.air_gain + m.named_gain, WEIGHTY)
    removed = m.last_gap - m.air_gap
    return {
        "tried": 1.0, "screen_gain": m.air_gain, "screen_share": share,
        "fit_gain": m.air_gain, "fit_share": share, "size": m.air_angle / LEAST_GUST_ANGLE,
        "gap_removed": removed / m.base_gap if m.base_gap > 0.0 else 0.0,
        "model_share": removed / max(m.base_gap - m.air_gap, 1e-9) if removed > 0.0 else 0.0,
        "few_maneuvers": once * _concentration(m.last),
        "shape": once * shape,
    }  # fmt: skip


def _concentration(residual: Residual) -> float:
    """Return the logarithm of the loudest manoeuvre's power over the median."""
    power: FloatArray = np.mean(residual.by_maneuver, axis=1)
    return float(np.log(max(np.max(power), 1e-12) / max(np.median(power), 1e-12)))


def _of_the_file(m: Measured) -> Values:
    """Return how far the file's numbers are from fitted ones."""
    return {
        "tried": 1.0,
        "file_gap": max(m.file_gap, 0.0),
        "file_distance": float(np.sqrt(max(m.file_distance, 0.0))),
    }


def _of_fitted_numbers(m: Measured) -> Values:
    """Return what fitted numbers remove of the gap."""
    gap = max(m.file_gap, 0.0)
    return {"gap_removed": gap / (gap + m.base_gap) if gap > 0.0 else 0.0}


def _of_courses(m: Measured, *blocks: str) -> Values:
    found = [m.courses[block] for block in blocks if block in m.courses]
    return {"drift": max(f[0] for f in found), "step": max(f[1] for f in found)} if found else {}
