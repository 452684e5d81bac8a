"""Check of the angle of attack against the motion, without aerodynamics.

The rate of the angle of attack by accelerometers, pitch rate and attitude is integrated and compared with the
α channel. No aerodynamic derivative is used, so any difference is an error of an instrument. (Klein &
Morelli, *Aircraft System Identification*, chapter 10, "data compatibility"; here for the longitudinal
motion.)
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from advisor.flight.instruments.delayed_fit import coloured_covariance
from advisor.flight.instruments.measured import (
    UNKNOWN,
    AlphaOffset,
    mean_offset,
    offset_of,
    speed_at,
    weighted,
)
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.derived_alpha import alpha_rate, integrated
from advisor.flight.signals.record import renewed
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95, symbol

NEEDED = ("alpha", "q", "theta", "a_z")
_FOLLOW_S = np.array([0.08, 0.2, 0.5, 1.2])
"""Time constants, s, that cover the responses of aircraft, from the fastest short period to the slowest."""
CORRUPTED_BY_LAG = ("Z_delta_e", "Z_q", "Z_alpha", "M_q")
"""Parameters that a late α biases. M_alpha and M_delta_e are not biased, because the lag only mixes α with
its own rate. The rate of α enters the moment equation as a change of M_q."""
KEPT = 32
"""Numerical: number of the newest checks that are kept."""
SMALLEST_LAG_S = 0.004
SMALLEST_SCALE = 0.01

Finding = Literal["consistent", "late", "early", "scaled", "inconsistent", "not possible"]


@dataclass(frozen=True, slots=True)
class KinematicCheck:
    """Result of the check of the α channel against the motion. Values are NaN where unknown."""

    finding: Finding
    sentence: str
    lag_s: float = float("nan")
    """Lag of the α channel, s; negative if early."""
    lag_std_s: float = float("nan")
    scale: float = float("nan")
    """Scale error k of the α channel, which reads (1 + k)·α."""
    scale_std: float = float("nan")
    offset: AlphaOffset = UNKNOWN
    """Mean offset of the α channel."""
    drift_rad_s: float = float("nan")
    """Rate at which reconstruction and α diverge, rad/s: bias of pitch rate and accelerometers together."""
    rms_rad: float = float("nan")
    """Root mean square difference of reconstruction and α after correction of lag, scale and drift, rad."""
    explained: float = float("nan")
    """Share of the variance of α that the reconstruction explains."""

    @property
    def possible(self) -> bool:
        return self.finding != "not possible"


def check_alpha(
    maneuver: Maneuver,
    airspeed_m_s: float | None = None,
    accelerometer_arm_m: float | None = None,
    vane_arm_m: float | None = None,
) -> KinematicCheck:
    """Compare α with the integral of α̇ = q + (a_z cos α − a_x sin α + g cos(θ − α))/V.

    Parameters
    ----------
    maneuver
        Manoeuvre with channels ``alpha``, ``q``, ``theta``, ``a_z``, and ``airspeed`` unless one is given.
        Channels ``a_x`` and ``climb_rate`` are used if present.
    airspeed_m_s
        Air speed of a log without an air speed, m/s.
    accelerometer_arm_m, vane_arm_m
        Distances of accelerometer and vane ahead of the centre of gravity, which are corrected if known. An
        unknown accelerometer arm appears as a small negative lag, and a vane arm as a lag.
    """
    return _checked(_Itself(maneuver), airspeed_m_s, accelerometer_arm_m, vane_arm_m)


class _Itself:
    """A manoeuvre that equals itself alone, as the key of its check."""

    def __init__(self, maneuver: Maneuver) -> None:
        self.maneuver = maneuver

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Itself) and self.maneuver is other.maneuver

    def __hash__(self) -> int:
        return id(self.maneuver)


@lru_cache(maxsize=KEPT)
def _checked(
    itself: _Itself, airspeed_m_s: float | None, accelerometer_arm_m: float | None, vane_arm_m: float | None
) -> KinematicCheck:
    """Return the check of one manoeuvre. A joint estimate asks again for every manoeuvre before it."""
    maneuver, channels = itself.maneuver, itself.maneuver.channels
    missing = [name for name in NEEDED if name not in channels or len(channels[name]) < 20]
    if speed_at(np.zeros(1), maneuver, airspeed_m_s) is None:
        missing.append("airspeed")
    if missing:
        listed = ", ".join(missing)
        said = f"alpha cannot be checked against the motion: no {listed} in this log."
        # The mean offset of alpha needs the attitude and the climb rate only.
        offset = offset_of(maneuver, airspeed_m_s) if missing == ["a_z"] else UNKNOWN
        return KinematicCheck("not possible", said, offset=offset)
    t_alpha, alpha = renewed(channels["alpha"].t, channels["alpha"].y)
    t = channels["q"].t
    speed = speed_at(t, maneuver, airspeed_m_s)
    assert speed is not None
    if np.min(speed) < 1.0 or len(t_alpha) < 12:
        return KinematicCheck("not possible", "alpha cannot be checked against the motion: no usable speed.")
    if vane_arm_m:
        alpha = alpha + vane_arm_m * np.interp(t_alpha, t, channels["q"].y / speed)
    rate = alpha_rate(t, np.interp(t, t_alpha, alpha), speed, channels, accelerometer_arm_m or 0.0)
    rebuilt = integrated(t, rate)
    elevator = channels.get("elevator")
    commanded = None if elevator is None else _followers(t, np.interp(t, elevator.t, elevator.y))
    return _compare(t, rebuilt, rate, commanded, t_alpha, alpha, offset_of(maneuver, airspeed_m_s))


def _followers(t: FloatArray, command: FloatArray) -> FloatArray:
    """Return the command after two equal first-order lags in series, for several time constants, shape (n,
    k).
    """
    moved = command - command[0]
    first = np.zeros(len(_FOLLOW_S))
    followed = np.zeros((len(t), len(_FOLLOW_S)))
    for i, dt in enumerate(np.diff(t), start=1):
        share = -np.expm1(-dt / _FOLLOW_S)
        first = first + share * (moved[i - 1] - first)
        followed[i] = followed[i - 1] + share * (first - followed[i - 1])
    return followed


def _compare(
    t: FloatArray,
    rebuilt: FloatArray,
    rate: FloatArray,
    commanded: FloatArray | None,
    t_alpha: FloatArray,
    alpha: FloatArray,
    offset: AlphaOffset,
) -> KinematicCheck:
    """Fit α(t) = (1 + k)·α_k(t − τ) + b_0 + b_1 t + b_2 t² by Gauss-Newton in τ, k and the b."""
    # A gust looks like a lag and a scale error; lagged commands are instrumental variables (2SLS).
    inside = (t_alpha >= t[0] + 0.3) & (t_alpha <= t[-1] - 0.3)
    tm, y = t_alpha[inside], alpha[inside]
    if len(tm) < 12 or np.ptp(y) < 1e-4:
        return KinematicCheck(
            "not possible", "alpha cannot be checked against the motion, because alpha hardly moved."
        )
    s = (tm - tm.mean()) / max(np.ptp(tm), 1e-9)
    slow = np.column_stack([np.ones_like(s), s, s**2])
    instruments = None
    if commanded is not None:
        followed = np.column_stack([np.interp(tm, t, column) for column in commanded.T])
        instruments = _orthogonal(np.column_stack([slow, followed]))
    best: tuple[float, FloatArray, FloatArray, FloatArray] | None = None
    for start in (0.0, 0.08, -0.08):
        tau = start
        for _ in range(12):
            shape, slope = np.interp(tm - tau, t, rebuilt), np.interp(tm - tau, t, rate)
            projected = _told_by(instruments, np.column_stack([shape, slow, slope]))
            linear = np.linalg.lstsq(projected[:, :-1], y, rcond=None)[0]
            jacobian = np.column_stack([-linear[0] * projected[:, -1], projected[:, :-1]])
            left = y - np.column_stack([shape, slow]) @ linear
            step = float(np.linalg.lstsq(jacobian, left, rcond=None)[0][0])
            tau = float(np.clip(tau + np.clip(step, -0.05, 0.05), -0.29, 0.29))
            if abs(step) < 1e-5:
                break
        cost = float(left @ left)
        if best is None or cost < best[0]:
            best = (cost, np.array([tau, *linear]), jacobian, left)
    assert best is not None
    cost, fitted, jacobian, left = best
    std = np.sqrt(np.diag(coloured_covariance(jacobian, left)))
    explained = 1.0 - cost / float(np.sum((y - slow @ np.linalg.lstsq(slow, y, rcond=None)[0]) ** 2))
    finding, sentence = _judge(fitted[0], std[0], fitted[1] - 1.0, std[1], explained)
    return KinematicCheck(
        finding, sentence, float(fitted[0]), float(std[0]), float(fitted[1] - 1.0), float(std[1]), offset,
        float(fitted[3] / max(np.ptp(tm), 1e-9)), float(np.sqrt(cost / len(y))), explained,
    )  # fmt: skip


def _orthogonal(columns: FloatArray) -> FloatArray:
    """Return orthonormal columns of equal span, without nearly vanishing directions."""
    left, size, _ = np.linalg.svd(
        columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300), full_matrices=False
    )
    return np.asarray(left[:, size > 1e-4 * size[0]])


def _told_by(instruments: FloatArray | None, columns: FloatArray) -> FloatArray:
    """Return the projection of the columns on the span of the instruments' columns. Without instruments
    return the columns.
    """
    return columns if instruments is None else np.asarray(instruments @ (instruments.T @ columns))


def _judge(
    lag: float, lag_std: float, scale: float, scale_std: float, explained: float
) -> tuple[Finding, str]:
    if explained < 0.7:
        share = 100 * max(explained, 0.0)
        return "inconsistent", (
            f"alpha does not follow the motion: it explains {share:.0f} % of alpha (gusts do this)."
        )
    if abs(lag) > max(SMALLEST_LAG_S, 3.0 * lag_std):
        word: Finding = "late" if lag > 0 else "early"
        return word, (
            f"alpha is {abs(lag) * 1e3:.0f} ± {NORMAL_95 * lag_std * 1e3:.0f} ms {word}: its fit gets "
            f"{', '.join(map(symbol, CORRUPTED_BY_LAG))} wrong, not M_α and M_δe; "
            "give alpha.vane_arm_m if it is a vane."
        )
    if abs(scale) > max(SMALLEST_SCALE, 3.0 * scale_std, 0.05):
        return (
            "scaled",
            f"alpha reads {100 * scale:+.0f} ± {100 * NORMAL_95 * scale_std:.0f} % off in scale against the "
            "motion.",
        )
    return (
        "consistent",
        f"alpha follows the motion (lag {lag * 1e3:+.0f} ± {NORMAL_95 * lag_std * 1e3:.0f} ms).",
    )


def combine(checks: Sequence[KinematicCheck]) -> KinematicCheck:
    """Return one check for the aircraft from the checks of its manoeuvres, as weighted means.

    Scatter between manoeuvres that exceeds their stated errors widens the error.
    """
    offset = mean_offset([c.offset for c in checks])
    usable = [c for c in checks if c.possible and np.isfinite(c.lag_std_s) and c.lag_std_s > 0.0]
    if not usable:
        first = (
            checks[0] if checks else KinematicCheck("not possible", "No manoeuvre allows a check of alpha.")
        )
        return replace(first, offset=offset)
    lag, lag_std = weighted([c.lag_s for c in usable], [c.lag_std_s for c in usable])
    scale, scale_std = weighted([c.scale for c in usable], [c.scale_std for c in usable])
    explained = float(np.median([c.explained for c in usable]))
    finding, sentence = _judge(lag, lag_std, scale, scale_std, explained)
    drift = float(np.mean([c.drift_rad_s for c in usable]))
    rms = float(np.sqrt(np.mean([c.rms_rad**2 for c in usable])))
    return KinematicCheck(
        finding, sentence, lag, lag_std, scale, scale_std, offset, drift, rms, explained
    )  # fmt: skip
