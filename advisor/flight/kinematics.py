"""Is the angle of attack what it claims to be? A check without any aerodynamics.

What the accelerometers, the pitch rate and the attitude say about the angle of attack is
integrated and held against the α channel. No derivative enters, so whatever disagrees is
an instrument, not the aircraft. (Klein & Morelli, *Aircraft System Identification*,
chapter 10, "data compatibility"; here for the longitudinal motion.)
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from advisor.flight.coloured import coloured_covariance
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.motion import integrated
from advisor.flight.renewal import renewed
from advisor.gravity import GRAVITY_M_S2

NEEDED = ("alpha", "q", "theta", "a_z")
_FOLLOW_S = np.array([0.08, 0.2, 0.5, 1.2])
"""Lags that span the responses of aircraft, from the fastest short period to the slowest."""
CORRUPTED_BY_LAG = ("Z_delta_e", "Z_q", "Z_alpha", "M_q")
"""What a late α spoils. M_alpha and M_delta_e keep their values: the lag only mixes α with
its own rate, and the rate of α enters the moment equation as a change of M_q."""
SMALLEST_LAG_S = 0.004
SMALLEST_SCALE = 0.01
SMALLEST_BIAS_RAD = np.radians(0.1)
_BEGIN_S, _STAYS, _SCATTERS = 1.0, 0.5, 3.0
"""The beginning of a record; share of itself that an offset may lack there, in the mean of all manoeuvres;
and how many times their scatter that takes."""
_NO_BIAS = (float("nan"), float("nan"), float("nan"))

Finding = Literal["consistent", "late", "early", "scaled", "inconsistent", "not possible"]


@dataclass(frozen=True, slots=True)
class KinematicCheck:
    """What the kinematics say about the α channel. NaN where it could not be told."""

    finding: Finding
    sentence: str
    missing: tuple[str, ...] = ()
    """Channels whose absence prevents the check."""
    lag_s: float = float("nan")
    """How late α arrives (negative: early)."""
    lag_std_s: float = float("nan")
    scale: float = float("nan")
    """Scale error k: the channel reads (1 + k)·α."""
    scale_std: float = float("nan")
    bias_rad: float = float("nan")
    """Mean of α minus (θ − flight-path angle); NaN without a climb rate."""
    bias_std_rad: float = float("nan")
    bias_change_rad: float = float("nan")
    """How much more it is over the record than in its first second; 0 within three times what manoeuvres
    scatter by. An instrument's offset is there from the first; air that begins to sink is not."""
    drift_rad_s: float = float("nan")
    """Rate at which reconstruction and α part: bias of pitch rate and accelerometers together."""
    rms_rad: float = float("nan")
    """What is left between the two when lag, scale and drift are allowed for."""
    explained: float = float("nan")
    """Share of the variance of α that the reconstruction explains."""

    @property
    def bias_stays(self) -> bool:
        """Whether nothing says that the offset was not there from the beginning."""
        return not abs(self.bias_change_rad) >= _STAYS * abs(self.bias_rad)

    @property
    def possible(self) -> bool:
        """Whether the channels sufficed."""
        return self.finding != "not possible"


def check_alpha(
    maneuver: Maneuver,
    airspeed_m_s: float | None = None,
    accelerometer_arm_m: float | None = None,
    vane_arm_m: float | None = None,
) -> KinematicCheck:
    """Compare α with what α̇ = q + (a_z cos α − a_x sin α + g cos(θ − α))/V integrates to.

    Parameters
    ----------
    maneuver
        With channels ``alpha``, ``q``, ``theta``, ``a_z``, and ``airspeed`` unless one is given; ``a_x``
        and ``climb_rate`` are used when present.
    airspeed_m_s
        Speed to use when the log has none.
    accelerometer_arm_m, vane_arm_m
        Distances of the accelerometer and the vane ahead of the centre of gravity, removed when known.
        An accelerometer's arm that is there and not given reads as a small negative lag, a vane's as a lag.
    """
    found = maneuver.channels
    missing = [name for name in NEEDED if name not in found or len(found[name]) < 20]
    if _speed_at(np.zeros(1), maneuver, airspeed_m_s) is None:
        missing.append("airspeed")
    if missing:
        listed = ", ".join(missing)
        said = f"alpha cannot be checked against the motion: no {listed} in this log."
        # What alpha is off on average takes the attitude and the climb rate only.
        offset = _bias(maneuver, airspeed_m_s) if missing == ["a_z"] else _NO_BIAS
        return KinematicCheck(
            "not possible", said, tuple(missing),
            bias_rad=offset[0], bias_std_rad=offset[1], bias_change_rad=offset[2],
        )  # fmt: skip
    t_alpha, alpha = renewed(found["alpha"].t, found["alpha"].y)
    t = found["q"].t

    def at(name: str) -> FloatArray:
        return np.interp(t, found[name].t, found[name].y)

    speed = _speed_at(t, maneuver, airspeed_m_s)
    assert speed is not None
    if np.min(speed) < 1.0 or len(t_alpha) < 12:
        return KinematicCheck("not possible", "alpha cannot be checked against the motion: no usable speed.")
    q, theta, a_z = found["q"].y, at("theta"), at("a_z")
    if accelerometer_arm_m:
        a_z = a_z + accelerometer_arm_m * np.gradient(q, t)
    if vane_arm_m:
        alpha = alpha + vane_arm_m * np.interp(t_alpha, t, q / speed)
    a_x = at("a_x") if "a_x" in found and len(found["a_x"]) > 1 else GRAVITY_M_S2 * np.sin(theta)
    alpha_now = np.interp(t, t_alpha, alpha)
    rate = (
        q
        + (a_z * np.cos(alpha_now) - a_x * np.sin(alpha_now) + GRAVITY_M_S2 * np.cos(theta - alpha_now))
        / speed
    )
    rebuilt = integrated(t, rate)
    commanded = _followers(t, at("elevator")) if "elevator" in found else None
    return _compare(t, rebuilt, rate, commanded, t_alpha, alpha, _bias(maneuver, airspeed_m_s))


def _speed_at(t: FloatArray, maneuver: Maneuver, otherwise: float | None) -> FloatArray | None:
    """Shape (n,): the logged air speed, else the one given; None without either."""
    logged = maneuver.channels.get("airspeed")
    if logged is not None and len(logged) > 1:
        return np.interp(t, logged.t, logged.y)
    return None if otherwise is None else np.full(len(t), otherwise)


def _followers(t: FloatArray, command: FloatArray) -> FloatArray:
    """What follows the command through two equal lags, shape (n, k): together they span the response."""
    moved = command - command[0]
    first = np.zeros(len(_FOLLOW_S))
    found = np.zeros((len(t), len(_FOLLOW_S)))
    for i, dt in enumerate(np.diff(t), start=1):
        share = -np.expm1(-dt / _FOLLOW_S)
        first = first + share * (moved[i - 1] - first)
        found[i] = found[i - 1] + share * (first - found[i - 1])
    return found


def _bias(maneuver: Maneuver, airspeed_m_s: float | None) -> tuple[float, float, float]:
    """Mean of α − (θ − γ), its error, and its change, from the climb rate; NaN without one."""
    found = maneuver.channels
    if "climb_rate" not in found or len(found["climb_rate"]) < 4:
        return _NO_BIAS
    climb = found["climb_rate"]

    def at(name: str) -> FloatArray:
        return np.interp(climb.t, found[name].t, found[name].y)

    speed = _speed_at(climb.t, maneuver, airspeed_m_s)
    assert speed is not None
    speed = np.maximum(speed, 1.0)
    apart = at("alpha") - (at("theta") - np.arcsin(np.clip(climb.y / speed, -0.9, 0.9)))
    # The climb rate is slow and smoothed: count one independent reading a second.
    independent = max(2.0, climb.t[-1] - climb.t[0])
    change = float(np.mean(apart) - np.mean(apart[climb.t <= climb.t[0] + _BEGIN_S]))
    return float(np.mean(apart)), float(np.std(apart) / np.sqrt(independent)), change


def _compare(
    t: FloatArray,
    rebuilt: FloatArray,
    rate: FloatArray,
    commanded: FloatArray | None,
    t_alpha: FloatArray,
    alpha: FloatArray,
    bias: tuple[float, float, float],
) -> KinematicCheck:
    """Fit α(t) = (1 + k)·α_k(t − τ) + b_0 + b_1 t + b_2 t² by Gauss-Newton in τ, k and the b.

    A gust moves the vane at once and the aircraft after it, which reads as a lag and a scale. It knows
    nothing of the command: what follows that is the instrument of the fit (two-stage least squares).
    """
    inside = (t_alpha >= t[0] + 0.3) & (t_alpha <= t[-1] - 0.3)
    tm, y = t_alpha[inside], alpha[inside]
    if len(tm) < 12 or np.ptp(y) < 1e-4:
        return KinematicCheck("not possible", "alpha cannot be checked against the motion: it hardly moved.")
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
            told = _told_by(instruments, np.column_stack([shape, slow, slope]))
            linear = np.linalg.lstsq(told[:, :-1], y, rcond=None)[0]
            jacobian = np.column_stack([-linear[0] * told[:, -1], told[:, :-1]])
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
        finding, sentence, (), float(fitted[0]), float(std[0]), float(fitted[1] - 1.0), float(std[1]), *bias,
        float(fitted[3] / max(np.ptp(tm), 1e-9)), float(np.sqrt(cost / len(y))), explained,
    )  # fmt: skip


def _orthogonal(columns: FloatArray) -> FloatArray:
    """Orthonormal columns of the same span, without directions that are next to none."""
    left, size, _ = np.linalg.svd(
        columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300), full_matrices=False
    )
    return np.asarray(left[:, size > 1e-4 * size[0]])


def _told_by(instruments: FloatArray | None, columns: FloatArray) -> FloatArray:
    """The part of the columns that lies in the instruments' span; all of it without any."""
    return columns if instruments is None else np.asarray(instruments @ (instruments.T @ columns))


def _judge(
    lag: float, lag_std: float, scale: float, scale_std: float, explained: float
) -> tuple[Finding, str]:
    """The finding in a word and in a sentence."""
    if explained < 0.7:
        share = 100 * max(explained, 0.0)
        return "inconsistent", (
            f"alpha does not follow the motion: it explains {share:.0f} % of alpha (gusts do this)."
        )
    if abs(lag) > max(SMALLEST_LAG_S, 3.0 * lag_std):
        word: Finding = "late" if lag > 0 else "early"
        return word, (
            f"alpha is {abs(lag) * 1e3:.0f} ± {lag_std * 1e3:.0f} ms {word}: its fit gets "
            f"{', '.join(CORRUPTED_BY_LAG)} wrong, not M_alpha and M_delta_e; "
            "give alpha.vane_arm_m if it is a vane."
        )
    if abs(scale) > max(SMALLEST_SCALE, 3.0 * scale_std, 0.05):
        return (
            "scaled",
            f"alpha reads {100 * scale:+.0f} ± {100 * scale_std:.0f} % off in scale against the motion.",
        )
    return "consistent", f"alpha follows the motion (lag {lag * 1e3:+.0f} ± {lag_std * 1e3:.0f} ms)."


def combine(checks: Sequence[KinematicCheck]) -> KinematicCheck:
    """One check for the aircraft from those of its manoeuvres: means weighted by their errors.

    The scatter between manoeuvres widens the error where it exceeds what each claims.
    """
    biased = [c for c in checks if np.isfinite(c.bias_rad)]
    bias = _NO_BIAS
    if biased:
        stds = [c.bias_std_rad for c in biased]
        changes = np.array([c.bias_change_rad for c in biased])
        scatter = np.std(changes) / np.sqrt(max(len(changes) - 1, 1))
        change = float(np.mean(changes))
        plain = len(changes) > 1 and abs(change) > _SCATTERS * scatter
        bias = (*_weighted([c.bias_rad for c in biased], stds), change if plain else 0.0)
    usable = [c for c in checks if c.possible and np.isfinite(c.lag_std_s) and c.lag_std_s > 0.0]
    if not usable:
        first = checks[0] if checks else KinematicCheck("not possible", "No manoeuvre to check alpha on.")
        return replace(first, bias_rad=bias[0], bias_std_rad=bias[1], bias_change_rad=bias[2])
    lag, lag_std = _weighted([c.lag_s for c in usable], [c.lag_std_s for c in usable])
    scale, scale_std = _weighted([c.scale for c in usable], [c.scale_std for c in usable])
    explained = float(np.median([c.explained for c in usable]))
    finding, sentence = _judge(lag, lag_std, scale, scale_std, explained)
    drift = float(np.mean([c.drift_rad_s for c in usable]))
    rms = float(np.sqrt(np.mean([c.rms_rad**2 for c in usable])))
    return KinematicCheck(
        finding, sentence, (), lag, lag_std, scale, scale_std, *bias, drift, rms, explained
    )  # fmt: skip


def _weighted(values: Sequence[float], stds: Sequence[float]) -> tuple[float, float]:
    y, s = np.array(values), np.maximum(np.array(stds), 1e-12)
    w = 1.0 / s**2
    mean = float(np.sum(w * y) / np.sum(w))
    chi2 = float(np.sum(w * (y - mean) ** 2)) / max(len(y) - 1, 1)
    return mean, float(np.sqrt(max(chi2, 1.0) / np.sum(w)))
