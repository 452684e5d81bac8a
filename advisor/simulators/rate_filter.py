"""A pitch rate filter that only the simulator has, found from the simulator's own attitude.

A replay has no noise. The relation θ̇ = q·cos φ − r·sin φ holds within the simulation's step, independent of
aerodynamics. A pitch rate that differs from the attitude's rate is late. The difference is τ·q̇ for a
first-order filter, and nearly so for a delay.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.effects.pitch_rate_skew import EFFECT
from advisor.gap.result import Cause, Diagnosis, Value
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import Replay


def unfiltered(replay: Replay) -> Replay:
    """Return the replay with a pitch rate computed from its own attitude."""
    rate = np.gradient(replay.theta, replay.t)
    if replay.bank is None:
        return replace(replay, q=rate)
    across, up = np.sin(replay.bank), np.cos(replay.bank)
    if replay.r is not None:
        return replace(replay, q=(rate + replay.r * across) / up)
    turn = GRAVITY_M_S2 / replay.airspeed_m_s * across / up
    return replace(replay, q=rate * up + turn * across)


def lateness(replays: Sequence[Replay]) -> Value:
    """Return the lag of the replays' pitch rate relative to the attitude's rate, s, by least squares."""
    missing, rate = (np.concatenate(series) for series in zip(*map(_departure, replays), strict=True))
    information = max(float(rate @ rate), 1e-300)
    lag_s = float(rate @ missing) / information
    rest = missing - lag_s * rate
    return Value(lag_s, float(np.sqrt(np.mean(rest**2) / information)))


def cause_of(late: Value, own: Diagnosis) -> Cause:
    """Return the filter as a cause, with the size that the aircraft lacks.

    Parameters
    ----------
    late
        Lag of the simulator's pitch rate, s.
    own
        Diagnosis of the replays without the lag. The probability of the cause is that of the answer "nothing"
        for these replays.
    """
    probabilities = own.probabilities
    likeliness = 0.0 if probabilities is None else probabilities.none + probabilities.parameters
    assert EFFECT.imitated_by is not None
    looks, way = EFFECT.imitated_by
    size = {"skew_s": Value(-late.value, late.std)}
    return Cause(EFFECT.name, EFFECT.block, likeliness, size, (looks,), way, float("nan"), present=True)


def _departure(replay: Replay) -> tuple[FloatArray, FloatArray]:
    """Return attitude rate minus pitch rate, rad/s, and pitch acceleration, rad/s², shape (m,) each."""
    return unfiltered(replay).q - replay.q, np.gradient(replay.q, replay.t)
