"""Examination of one record's instruments: contradictions, and channels with known errors removed.

Each check of an instrument builds on the checks before. The order is: attitude and pitch rate, unit of the
specific force, clocks, angle of attack, air speed.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import degrees, pi

import numpy as np

from advisor.flight.instruments.evidence import (
    VANE_WIDTH,
    alpha_against_motion,
    force_against_alpha,
    force_against_climb,
    rate_against_attitude,
    rate_moves_alpha,
    speed_against_force,
)
from advisor.flight.instruments.examined import (
    ALLOWED,
    FILTER_S,
    PLAIN,
    REVERSED,
    SIGMAS,
    Examined,
    Work,
    be_late,
    half_intervals,
    hold_clocks,
    hold_force_unit,
    hold_rate,
    with_error,
)
from advisor.flight.instruments.measured import ANY, Evidence, Measured, Weighed, weigh
from advisor.flight.signals.record import Channel

_AIRSPEED_WIDTH, _AIRSPEED_MEAN = 0.12, 0.95
"""Prior standard deviation and mean of the ratio of the logged to the true air speed. An indicated air speed
is 1.00 of the true one at sea level and 0.86 at 3,000 m; position error is about 5 %."""
_SPEED_UNITS_M_S = {"knots": 0.514444, "km/h": 1.0 / 3.6, "mph": 0.44704, "ft/s": 0.3048}


def examine(channels: Mapping[str, Channel], earlier: Evidence | None = None) -> Examined:
    """Examine the instruments of a record."""
    work = Work(dict(channels), earlier or {})
    if _attitude_and_rate(work) and hold_force_unit(work):
        hold_clocks(work, "q", "theta")
        if _speed_unit(work):
            _alpha_and_force(work)
        _force_behind_climb(work)
    return work.done


def _attitude_and_rate(work: Work) -> bool:
    """Compare the pitch rate with the attitude; return whether sign and unit agree."""
    measured = work.learn(rate_against_attitude(work.channels)).get("theta_scale")
    return hold_rate(
        work, measured, "q", "theta", lambda: "theta" if rate_moves_alpha(work.channels) else "q"
    )


def _alpha_and_force(work: Work) -> None:
    """Compare angle of attack, specific force and air speed with each other."""
    if not work.has("alpha"):
        return
    _unwrap_alpha(work)
    scale = work.learn(alpha_against_motion(work.channels)).get("alpha_scale")
    weighed = _weighed_alpha(scale) if scale is not None else None
    if scale is not None and weighed is not None and weighed.contradicts and weighed.best != ANY:
        _name_alpha(work, weighed, scale)
        return
    evidence = work.learn(force_against_alpha(work.channels)) if work.has("q", "a_z", "airspeed") else {}
    if evidence and (_clock_of_force(work, evidence) or _airspeed(work, evidence)):
        return
    if scale is not None and weighed is not None and weighed.contradicts:
        _name_alpha(work, weighed, scale)


def _unwrap_alpha(work: Work) -> None:
    """Convert an angle of attack between 0 and 360 deg into one about zero."""
    alpha = work.channels["alpha"]
    near_zero = (alpha.y >= 0.0) & (np.abs(alpha.y - pi) > pi / 2.0) & (alpha.y < 2.01 * pi)
    if not np.all(near_zero) or np.max(alpha.y) < pi:
        return
    work.contradict(
        "alpha", "unit", "-180 to 180 deg", "0 to 360 deg", Measured(degrees(float(np.max(alpha.y))), 0.0),
        "alpha is counted from 0 to 360 deg; estimates count it about 0",
        f"send {alpha.source} from -180 to 180 deg", used=True,
    )  # fmt: skip
    work.correct("alpha", lambda channel: replace(channel, y=(channel.y + pi) % (2.0 * pi) - pi))


def _weighed_alpha(scale: Measured) -> Weighed:
    factors = {
        REVERSED: -1.0,
        "in rad": pi / 180.0,
        "in deg": 180.0 / pi,
        "reversed and in rad": -pi / 180.0,
        "reversed and in deg": -180.0 / pi,
    }
    return weigh(scale, factors, VANE_WIDTH)


def _name_alpha(work: Work, weighed: Weighed, scale: Measured) -> None:
    source = work.channels["alpha"].source
    said = f"it moves {with_error(scale)} times as far as pitch rate and specific force say"
    if weighed.best == ANY:
        work.contradict(
            "alpha", "scale", 1.0, scale.value, scale, f"alpha is no angle of attack: {said}",
            f"check the vane and its calibration ({source})",
        )  # fmt: skip
    elif weighed.best == REVERSED:
        work.contradict(
            "alpha", "sign", "nose up", "nose down", scale, f"alpha has the wrong sign: {said}",
            f"reverse the sign of {source}: an angle of attack is positive nose up",
        )  # fmt: skip
    else:
        unit = weighed.best[-3:]
        stated = "deg" if unit == "rad" else "rad"
        work.contradict(
            "alpha", "unit", stated, unit, scale, f"alpha is {weighed.best} where {stated} is stated: {said}",
            f"send {source} in {stated}, positive nose up",
        )  # fmt: skip


def _clock_of_force(work: Work, evidence: Mapping[str, Measured]) -> bool:
    """Compare the clock of the specific force with that of the pitch rate; return whether they differ."""
    least, most = evidence.get("a_z_least"), evidence.get("a_z_most")
    range_s = FILTER_S + half_intervals(work, "q", "a_z")
    exact = least is not None and most is not None and most.value - least.value < range_s
    late_rate = next((f for f in work.findings if f.code == "q_delay_s"), None)
    if least is not None and least.value - SIGMAS * least.std > range_s:
        late = most if exact and most is not None else least
        other = PLAIN["q" if late_rate is None else "theta"]
        shifted = ("a_z", "a_x") if exact else ()
        be_late(work, "a_z", other, late, used=exact, bound=not exact, shifted=shifted)
        return True
    if most is not None and most.value + SIGMAS * most.std < -range_s:
        be_late(work, "q", PLAIN["a_z"], Measured(-most.value, most.std), used=False)
        return True
    # A force as late as the pitch rate would have shown: nothing else but the pitch rate is late.
    if late_rate is not None and exact and most is not None and SIGMAS * most.std < FILTER_S + range_s:
        work.findings[work.findings.index(late_rate)] = replace(
            late_rate, used=True, text=late_rate.text + ALLOWED
        )
    return False


def _force_behind_climb(work: Work) -> None:
    """Compare clocks of specific force and climb rate, if no other check has determined it."""
    if any(f.code == "a_z_delay_s" for f in work.findings):
        return
    least = work.learn(force_against_climb(work.channels)).get("a_z_behind_climb")
    if least is None or not work.has("a_z", "climb_rate"):
        return
    range_s = FILTER_S + half_intervals(work, "a_z", "climb_rate")
    if least.value - SIGMAS * least.std > range_s:
        be_late(work, "a_z", "the climb rate", least, used=False, bound=True)


def _speed_unit(work: Work) -> bool:
    """Compare the change of the air speed with the accelerometers; return whether the air speed has the
    stated unit.
    """
    scale = work.learn(speed_against_force(work.channels)).get("speed_scale")
    if scale is None or not work.has("airspeed"):
        return True
    weighed = _weighed_speed(scale)
    # A gust changes the air speed by any amount, which is no unit.
    if weighed.contradicts and weighed.best != ANY:
        _name_speed(work, weighed, scale, "its change is {} times the change that the accelerometers give")
        return False
    return True


def _weighed_speed(scale: Measured) -> Weighed:
    factors = {unit: 1.0 / size for unit, size in _SPEED_UNITS_M_S.items()}
    return weigh(scale, factors, _AIRSPEED_WIDTH, _AIRSPEED_MEAN)


def _airspeed(work: Work, evidence: Mapping[str, Measured]) -> bool:
    """Compare the air speed with the motion; return whether both contradict each other."""
    scale = evidence.get("airspeed_scale")
    if scale is None:
        return False
    weighed = _weighed_speed(scale)
    if weighed.contradicts:
        by = "it reads {} times the speed that pitch rate, specific force and alpha give"
        _name_speed(work, weighed, scale, by)
    return weighed.contradicts


def _name_speed(work: Work, weighed: Weighed, scale: Measured, by: str) -> None:
    said = by.format(with_error(scale))
    if weighed.best == ANY:
        work.contradict(
            "airspeed", "scale", 1.0, scale.value, scale, f"the air speed is wrong: {said}",
            "check the air speed sensor and its calibration",
        )  # fmt: skip
    else:
        work.contradict(
            "airspeed", "unit", "m/s", weighed.best, scale, f"the air speed is in {weighed.best}: {said}",
            "send the air speed in m/s",
        )  # fmt: skip
