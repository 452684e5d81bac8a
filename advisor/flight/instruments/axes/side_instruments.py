"""Examination of the roll and yaw instruments of one record.

The order is: roll rate and bank, unit of the specific force, clock of the roll rate, sideslip, side force.

The bank's rate is p + tan θ·(q·sin φ + r·cos φ). The sideslip's rate is β̇ = a_y/V + b + c. The weight's part
is b = (g/V)·cos θ·sin φ, and the turn rate's part is c = sin α·p - cos α·r. On every aircraft the side force
opposes the sideslip: a_y/V = Y_β·β with Y_β < 0. The sign of each part in a measured sideslip and in a side
force is therefore known.

An oscillation that is late by half a period has the opposite sign. A wrong sign is therefore certain only if
no shift of the stamps explains the signal with the right sign.
"""

from collections.abc import Mapping, Sequence
from math import exp, log
from typing import NamedTuple

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.delayed_fit import DRIFT, LONGEST_DELAY_S, DelayedFit, Summand, fit_delays
from advisor.flight.instruments.evidence import MOVED_RAD, Channels, usable
from advisor.flight.instruments.examined import (
    FORCE_UNITS_M_S2,
    PLAIN,
    SIGMAS,
    Examined,
    Work,
    hold_clocks,
    hold_force_unit,
    hold_rate,
    stated_force_unit,
    turned,
    with_error,
)
from advisor.flight.instruments.measured import ANY, EXCLUDED, Evidence, Measured, weigh
from advisor.flight.signals.derived_alpha import channel_at, integrated
from advisor.flight.signals.record import Channel, renewed
from advisor.process.arrays import FloatArray

FARTHEST_S = 3.0
"""Largest clock error in the search, s: half a period of a slow Dutch roll (6 s)."""
_STEP_S = 0.05
"""Distance of the delays in the search, s: a fortieth of the period of a fast Dutch roll."""
CLOCK_STD_S = 0.1
"""Standard deviation of a clock error that is found, s. The side force is not a part of the expected signal,
and shifts the sideslip of a small aircraft by 0.2 s."""


class _Try(NamedTuple):
    """Fit of a signal at one delay."""

    delay_s: float
    factor: float
    unexplained: float
    """Mean square of the residual over that of the signal without its drift."""
    independent: float
    """Number of independent samples of the residual."""


class SignOrClock(NamedTuple):
    """Evidence about a signal with a seemingly wrong sign."""

    is_sign: bool
    """Whether a wrong sign explains the signal, and a clock error is excluded at 99 %."""
    late_s: float
    """Delay at which the right sign explains the signal best, s."""
    is_clock: bool
    """Whether the clock error explains the signal better than a wrong sign."""


def sign_or_clock(
    t: FloatArray, y: FloatArray, grid: FloatArray, shape: FloatArray, sense: float, drift: int
) -> SignOrClock:
    """Compare a wrong sign with a clock error as the cause of a signal.

    Parameters
    ----------
    t, y
        Shape (n,): stamps, s, and values of the signal.
    grid, shape
        Shape (m,): stamps, s, and values of the expected signal, up to a factor.
    sense
        Sign of the factor on every aircraft.
    drift
        Degree of the polynomial in time that is added to the signal.
    """
    delays = np.arange(-FARTHEST_S, FARTHEST_S + _STEP_S / 2.0, _STEP_S)
    tries = [fit for delay in delays.tolist() if (fit := _tried(t, y, grid, shape, delay, drift)) is not None]
    right = [fit for fit in tries if fit.factor * sense > 0.0]
    wrong = [fit for fit in tries if fit.factor * sense < 0.0 and abs(fit.delay_s) <= LONGEST_DELAY_S]
    if not wrong or not right:
        return SignOrClock(bool(wrong), 0.0, bool(right))
    clock, sign = _best(right), _best(wrong)
    nats = 0.5 * min(clock.independent, sign.independent) * log(clock.unexplained / sign.unexplained)
    return SignOrClock(nats > -log(EXCLUDED), clock.delay_s, nats < log(EXCLUDED))


def _best(tries: Sequence[_Try]) -> _Try:
    return min(tries, key=lambda fit: fit.unexplained)


def _tried(
    t: FloatArray, y: FloatArray, grid: FloatArray, shape: FloatArray, delay_s: float, drift: int
) -> _Try | None:
    """Return the fit at one delay; None if the shift leaves less than half of the samples."""
    inside = (t - delay_s >= grid[0]) & (t - delay_s <= grid[-1])
    if np.count_nonzero(inside) < max(len(t) // 2, drift + 4):
        return None
    at, seen = t[inside] - delay_s, y[inside]
    slow = np.vander((at - at.mean()) / max(np.ptp(at), 1e-9), drift + 1)
    moved = np.interp(at, grid, shape)
    columns = np.column_stack([moved, slow])
    fitted = np.linalg.lstsq(columns, seen, rcond=None)[0]
    residual = seen - columns @ fitted
    whole = seen - slow @ np.linalg.lstsq(slow, seen, rcond=None)[0]
    power = float(np.mean(whole**2))
    if not power > 0.0:
        return None
    noise = residual - residual.mean()
    keep = min(max(float(noise[1:] @ noise[:-1]) / max(float(noise @ noise), 1e-300), 0.0), 0.99)
    share = max(float(np.mean(residual**2)) / power, 1e-9)
    return _Try(delay_s, float(fitted[0]), share, len(seen) * (1.0 - keep) / (1.0 + keep))


_TURNED_RAD = 0.75 * np.pi
"""Largest bank, rad, of a record with which the roll rate is tested. Beyond half a turn the bank angle
jumps."""


def rate_against_bank(channels: Channels) -> Evidence:
    """Return ``bank_scale``, the bank's change over the integral of its rate, and ``p_delay``, the roll
    rate's delay relative to the bank, s.

    The result is empty if the bank hardly moves, or turns over.
    """
    if not usable(channels, "p", "bank", "theta"):
        return {}
    p, bank = channels["p"], channels["bank"]
    angle, theta = channel_at("bank", p.t, channels), channel_at("theta", p.t, channels)
    by_turn = channel_at("q", p.t, channels) * np.sin(angle) + channel_at("r", p.t, channels) * np.cos(angle)
    if np.ptp(bank.y) < MOVED_RAD or np.max(np.abs(bank.y)) > _TURNED_RAD:
        return {}
    fit = fit_delays(bank.t, bank.y, [Summand(p.t, p.y + np.tan(theta) * by_turn)])
    return {} if fit is None else {"bank_scale": fit.factor(), "p_delay": fit.lateness}


def sideslip_against_motion(channels: Channels) -> Evidence:
    """Return the factors of the parts of β̇ in a measured sideslip; empty if nothing moves.

    ``beta_by_weight``, ``beta_by_turn`` and their common factor ``beta_by_motion`` are near 1.
    ``beta_by_force``, also near 1, is the side force over its reading.
    """
    parts = _parts(channels, "beta")
    if parts is None:
        return {}
    t, weight, turn = parts
    stamps, beta = renewed(channels["beta"].t, channels["beta"].y)
    apart = fit_delays(stamps, beta, [Summand(t, weight), Summand(t, turn)])
    together = fit_delays(stamps, beta, [Summand(t, weight + turn)])
    if apart is None or together is None:
        return {}
    evidence = _factors("beta", apart, together)
    force = channel_at("a_y", t, channels) / channel_at("airspeed", t, channels)
    both = [Summand(t, weight + turn, 1.0), Summand(t, force)]
    with_force = fit_delays(stamps, beta, both) if np.ptp(force) > 0.0 else None
    if with_force is not None:
        evidence["beta_by_force"] = with_force.factor(1)
    return evidence


def force_against_motion(channels: Channels) -> Evidence:
    """Return the factors of the parts of β̇ in the side force over the speed, 1/s; empty if nothing moves.

    ``a_y_by_weight``, ``a_y_by_turn`` and their common factor ``a_y_by_motion`` are Y_β. ``a_y_in_g`` is
    V·Y_β/g = C_Yβ/C_L, the side force of one radian over the weight.
    """
    parts = _parts(channels, "a_y")
    if parts is None:
        return {}
    t, weight, turn = parts
    force = channels["a_y"]
    speed = channel_at("airspeed", force.t, channels)
    apart = fit_delays(force.t, force.y / speed, [Summand(t, weight), Summand(t, turn)], np.zeros(2), drift=1)
    together = fit_delays(force.t, force.y / speed, [Summand(t, weight + turn)], np.zeros(1), drift=1)
    if apart is None or together is None:
        return {}
    evidence = _factors("a_y", apart, together)
    both, per_g = evidence["a_y_by_motion"], float(np.mean(speed)) / GRAVITY_M_S2
    return {**evidence, "a_y_in_g": Measured(both.value * per_g, both.std * per_g)}


def _factors(name: str, apart: DelayedFit, together: DelayedFit) -> dict[str, Measured]:
    """Return the separate factors of weight and turn rate, and their common factor."""
    parts = {"weight": apart.factor(), "turn": apart.factor(1), "motion": together.factor()}
    return {f"{name}_by_{part}": factor for part, factor in parts.items()}


def _parts(channels: Channels, name: str) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return stamps, and the parts of β̇ by weight and by turn rate, rad/s; None without a moving channel."""
    if not usable(channels, "r", "p", "bank", "theta", "airspeed", name):
        return None
    t = channels["r"].t
    speed, bank = channel_at("airspeed", t, channels), channels["bank"]
    still = np.ptp(bank.y) < MOVED_RAD or np.ptp(channels[name].y) == 0.0
    if still or np.min(speed) <= 0.0 or np.min(channels["airspeed"].y) <= 0.0:
        return None
    alpha, theta = channel_at("alpha", t, channels), channel_at("theta", t, channels)
    weight = GRAVITY_M_S2 / speed * np.cos(theta) * np.sin(channel_at("bank", t, channels))
    turn = np.sin(alpha) * channel_at("p", t, channels) - np.cos(alpha) * channels["r"].y
    return t, weight, turn


_FORCE_WIDTH = 0.3
"""Prior standard deviation of the side force's scale from a measured sideslip, as a share. The side force is
a small part of the sideslip's rate, so a vane's scale error is amplified."""
_USUAL_IN_G, _SPREAD = 2.0, 0.8
"""Prior mean, and standard deviation of the logarithm, of the side force per sideslip over the weight,
|C_Yβ|/C_L. Four recorded aircraft have values of 0.7 to 4.9."""


def examine_side(channels: Mapping[str, Channel], earlier: Evidence | None = None) -> Examined:
    """Examine the roll and yaw instruments of a record."""
    work = Work(dict(channels), earlier or {})
    if _bank_and_rate(work) and hold_force_unit(work):
        hold_clocks(work, "p", "bank")
        evidence = work.learn(sideslip_against_motion(work.channels))
        if _signs(work, "beta", evidence, 1.0):
            evidence = work.learn(force_against_motion(work.channels))
            if _signs(work, "a_y", evidence, -1.0):
                _side_force_unit(work, evidence)
    return work.done


def _bank_and_rate(work: Work) -> bool:
    """Compare the roll rate with the bank; return whether sign and unit agree."""
    measured = work.learn(rate_against_bank(work.channels)).get("bank_scale")
    return hold_rate(work, measured, "p", "bank", lambda: "p")


def _signs(work: Work, name: str, evidence: Evidence, sense: float) -> bool:
    """Compare the signs of both parts of the sideslip with ``sense``; return whether they agree."""
    parts = [evidence.get(f"{name}_by_{part}") for part in ("weight", "turn")]
    both = evidence.get(f"{name}_by_motion")
    wrong = [part is not None and _resolved(part) and part.value * sense < 0.0 for part in (*parts, both)]
    right = [part is not None and _resolved(part) and part.value * sense > 0.0 for part in parts]
    if (wrong[2] and not any(right)) or all(wrong[:2]):
        culprit = name
    elif wrong[0] and right[1]:
        culprit = "bank"
    elif wrong[1] and right[0]:
        culprit = "r"
    else:
        return True
    weight, turn = parts
    assert weight is not None
    assert turn is not None
    law = "the side force opposes the sideslip" if name == "a_y" else "the sideslip follows bank and turn"
    measured = turn if culprit == "r" else weight
    decided = f"with {with_error(weight)} and {with_error(turn)} of the parts by bank and by turn"
    if culprit == name:
        seen = _sign_or_clock(work, name, sense)
        if seen is not None and seen.is_clock:
            _of_another_clock(work, name, seen.late_s)
            return False
        if seen is not None and not seen.is_sign:
            return True
        if both is not None and not all(wrong[:2]):
            measured, decided = both, f"with {with_error(both)} of both parts together"
    turned(work, culprit, measured, f"{law}, {decided}")
    return False


def _of_another_clock(work: Work, name: str, late_s: float) -> None:
    late = Measured(abs(late_s), CLOCK_STD_S)
    side = "late" if late_s > 0.0 else "early"
    work.contradict(
        name, "delay_s", None, late_s, late,
        f"{PLAIN[name]} is {with_error(late)} s {side} relative to the motion",
        f"check the stamps of {PLAIN[name]} ({work.channels[name].source})",
    )  # fmt: skip


def _sign_or_clock(work: Work, name: str, sense: float) -> SignOrClock | None:
    """Compare a wrong sign of a channel with a clock error; None without a moving channel."""
    parts = _parts(work.channels, name)
    if parts is None:
        return None
    grid, weight, turn = parts
    shape = integrated(grid, weight + turn)
    channel = work.channels[name]
    if name == "a_y":
        force = channel.y / channel_at("airspeed", channel.t, work.channels)
        return sign_or_clock(channel.t, force, grid, shape, sense, 1)
    stamps, beta = renewed(channel.t, channel.y)
    return sign_or_clock(stamps, beta, grid, shape, sense, DRIFT)


def _resolved(measured: Measured) -> bool:
    return abs(measured.value) > SIGMAS * measured.std


def _side_force_unit(work: Work, evidence: Evidence) -> None:
    """Compare the unit of the side force with a measured sideslip, or with the usual side force."""
    if not work.has("a_y"):
        return
    source = work.channels["a_y"].source
    stated = stated_force_unit(source)
    factors = {unit: size / FORCE_UNITS_M_S2[stated] for unit, size in FORCE_UNITS_M_S2.items()}
    by_vane, in_g = evidence.get("beta_by_force"), evidence.get("a_y_in_g")
    if by_vane is not None and _resolved(by_vane):
        others = {unit: factor for unit, factor in factors.items() if unit != stated}
        weighed = weigh(by_vane, others, _FORCE_WIDTH)
        if weighed.contradicts:
            unit = "an unknown unit" if weighed.best == ANY else weighed.best
            _in_unit(work, stated, unit, by_vane, "the ratio that the sideslip requires is")
    elif in_g is not None and _resolved(in_g):
        likely = {unit: _likelihood(abs(in_g.value) * factor) for unit, factor in factors.items()}
        best = max(likely, key=lambda unit: likely[unit])
        if likely[stated] < EXCLUDED * sum(likely.values()):
            _in_unit(
                work,
                stated,
                best,
                in_g,
                "the ratio of the side force to the weight, for one radian of sideslip, is",
            )


def _likelihood(in_g: float) -> float:
    """Return the prior density of the side force per sideslip over the weight, up to a constant."""
    return exp(-0.5 * (log(in_g / _USUAL_IN_G) / _SPREAD) ** 2)


def _in_unit(work: Work, stated: str, unit: str, measured: Measured, observation: str) -> None:
    work.contradict(
        "a_y", "unit", stated, unit, measured,
        f"the side force is in {unit}, not in {stated}: {observation} {with_error(measured)}",
        f"send {work.channels['a_y'].source} in {stated}",
    )  # fmt: skip
