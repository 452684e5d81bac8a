"""What cannot be told apart, exactly or nearly, and what would break the tie."""

from collections.abc import Sequence

from advisor.gap.search.merit import Judged

NEAR = 5.0
"""Difference of held-out log likelihood below which two explanations are a tie."""
_TWINS = (
    {"alpha_vane_offset", "accelerometer_offset"}, {"alpha_lag", "alpha_skew"}, {"mass_change", "icing"},
)  # fmt: skip
"""Two arms that one measurement parts; a vane's filter of second order is between a lag and a skew; and ice
that takes the same share of everything is a heavier aircraft."""
_LITTLE = 0.1
_ARMS = "measure where the vane and the IMU sit: alpha.vane_arm_m, accelerometer.arm_m"
_SURFACE = "log the measured surface position"
_AMPLITUDES = "fly two amplitudes: a rate limit answers larger steps later"
_SPEEDS = "fly at two air speeds: the arm's part goes with 1/V, the other does not"
_WEIGHT = "log fuel and weight; ice moves lift and control by different shares"
_TRIM = "see which elevator trims level flight at several speeds: there the angle of attack is steady"
_REPEAT = "repeat the same manoeuvre at the same air speed, early and late"
_FILTERED = frozenset({"pitch_rate_skew", "accelerometer_skew", "attitude_skew"})
"""Late channels that may as well be filtered ones; of the angle of attack that has a name of its own."""
_BREAKS = {
    frozenset({"alpha_vane_offset", "accelerometer_offset"}): _ARMS,
    frozenset({"transport_delay", "actuator_lag"}): _SURFACE,
    frozenset({"transport_delay", "actuator_rate_limit"}): _AMPLITUDES,
    frozenset({"actuator_lag", "actuator_rate_limit"}): _AMPLITUDES,
    frozenset(
        {"alpha_lag", "alpha_skew"}
    ): "fly faster steps, or compare the channel's stamps with the vane's",
    frozenset({"alpha_lag", "alpha_vane_offset"}): _SPEEDS,
    frozenset({"alpha_skew", "alpha_vane_offset"}): _SPEEDS,
    frozenset(
        {"nonlinear_pitching_moment", "elevator_nonlinearity"}
    ): "fly slow and fast steps of equal size",
    frozenset({"mass_change", "icing"}): _WEIGHT,
    frozenset({"mass_change", "cg_shift"}): _WEIGHT,
    frozenset({"cg_shift", "icing"}): _WEIGHT,
    frozenset({"airspeed_variation", "mass_change"}): _REPEAT,
    frozenset({"airspeed_variation", "icing"}): _REPEAT,
    frozenset({"airspeed_variation", "cg_shift"}): _REPEAT,
    frozenset({"turbulence", "gust"}): "fly more manoeuvres: a gust does not come back, turbulence does",
    frozenset({"alpha_dot", "unsteady_lift"}): "log the accelerometer at a higher rate",
    frozenset({"actuator_backlash", "actuator_deadband"}): "fly two amplitudes, and steps short of neutral",
}


def breaking(effect: str, other: str) -> str:
    """What would tell two effects apart; empty when nothing particular is known."""
    return _BREAKS.get(frozenset({effect, other}), "")


def _near(a: Judged, b: Judged) -> bool:
    """As good as each other; twins if what parts them is little beside what either explains."""
    twins = {a.effect, b.effect} in _TWINS
    return abs(a.gain - b.gain) < (max(NEAR, _LITTLE * abs(b.gain)) if twins else NEAR)


def tied_with(best: Judged, others: Sequence[Judged], channels: Sequence[str]) -> tuple[tuple[str, ...], str]:
    """Effects that explain the data as well as ``best``, and what would tell them apart."""
    names = [j.effect for j in others if j.effect != best.effect and _near(j, best) and j.gain > 0.0]
    ways = []
    for name in names:
        found = breaking(best.effect, name)
        if found:
            ways.append(found)
    if best.effect == "transport_delay":
        names.append("an equal delay of every logged stream")
        ways.append(_SURFACE)
    if best.effect in _FILTERED:
        names.append("a filter of that channel that delays as much")
        ways.append("log the channel as its sensor reads it, before any filter")
    if best.effect == "alpha_scale" and "a_z" not in channels:
        names.append("Z_q of the model")
        ways.append("log the accelerometer (RAW_IMU) at 50 Hz")
    if best.variant.twin is not None:
        names.append("other derivatives of the pitching moment")
        ways.append(_TRIM)
    if best.effect == "actuator_deadband":
        names.append("lower elevator effectiveness, at one amplitude")
        ways.append("fly two amplitudes")
    if names and not ways:
        ways.append("fly more manoeuvres, with another time unit and another amplitude")
    return tuple(names), "; ".join(dict.fromkeys(ways))
