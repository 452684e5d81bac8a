"""Moving air in what a fit leaves over: turbulence told from instruments, by a Kalman filter's likelihood.

About a simulated flight the model is linear:

    δα̇ = Z_α (δα + η) + (1 + Z_q) δq,   δq̇ = M_α (δα + η) + M_q δq,   δθ̇ = δq,   η̇ = −η/T_g + white

with η the gust angle w/V, plus coloured noise of each sensor's own. A gust enters the vane, the lift and
the moment together, an instrument's noise only its own channel: the likelihoods of the two tell them apart
(Jategaonkar, *Flight Vehicle System Identification*, chapter 5).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from advisor.flight.messages import FloatArray
from advisor.oem.estimate import ChannelFit, Estimate

STATES = 8
CHANNELS = ("alpha", "q", "a_z", "theta")
ALPHA, Q, A_Z, THETA = range(4)
_LARGE = 1e3


@dataclass(frozen=True)
class AirModel:
    """Noise of the instruments and motion of the air, as standard deviations in SI."""

    white: FloatArray
    """Shape (4,): white noise of α, q, a_z, θ."""
    coloured: FloatArray
    """Shape (4,): noise with memory, by channel."""
    memory_s: float
    """Of the coloured noise."""
    gust: float
    """Of the gust angle w/V, rad; 0 for still air."""
    gust_memory_s: float
    seen_by_alpha: float = 1.0
    """1 when the α channel reads the air (a vane), 0 when it is made from inertial sensors."""


@dataclass(frozen=True)
class Rows:
    """Residuals of one manoeuvre in order of time."""

    t: FloatArray
    channel: np.ndarray
    """Shape (n,), int64: index into ``CHANNELS``."""
    left: FloatArray
    speed: float


@njit(cache=True)
def whiten(
    t: FloatArray, channel: np.ndarray, columns: FloatArray, system: FloatArray, noise: FloatArray
) -> tuple[float, FloatArray]:
    """Run one filter over several columns at once: the gains are the same for all.

    Parameters
    ----------
    t, channel
        Shape (n,), ascending times and channel of every row.
    columns
        Shape (n, k): residual first, then sensitivities.
    system
        Z_α, Z_q, M_α, M_q, V.
    noise
        White (4), coloured (4), memory, gust, gust memory, seen by α.

    Returns
    -------
    -2 log likelihood of the first column without its constant, and all columns whitened, shape (n, k).
    """
    n, k = columns.shape
    out = np.empty((n, k))
    z_a, z_q, m_a, m_q, speed = system[0], system[1], system[2], system[3], system[4]
    memory, gust, gust_memory, seen = noise[8], noise[9], noise[10], noise[11]
    A = np.zeros((4, 4))
    A[0, 0], A[0, 1], A[0, 3] = z_a, 1.0 + z_q, z_a
    A[1, 0], A[1, 1], A[1, 3] = m_a, m_q, m_a
    A[2, 1] = 1.0
    H = np.zeros((4, STATES))
    H[ALPHA, 0], H[ALPHA, 3], H[ALPHA, 4] = 1.0, seen, 1.0
    H[Q, 1], H[Q, 5] = 1.0, 1.0
    H[A_Z, 0], H[A_Z, 1], H[A_Z, 3], H[A_Z, 6] = speed * z_a, speed * z_q, speed * z_a, 1.0
    H[THETA, 2], H[THETA, 7] = 1.0, 1.0
    P = np.zeros((STATES, STATES))
    P[0, 0], P[1, 1], P[2, 2] = _LARGE, _LARGE, _LARGE
    P[3, 3] = gust * gust
    for c in range(4):
        P[4 + c, 4 + c] = noise[4 + c] ** 2
    X = np.zeros((STATES, k))
    F = np.eye(STATES)
    cost = 0.0
    for i in range(n):
        dt = t[i] - t[i - 1] if i > 0 else 0.0
        if dt > 1e-9:
            A[3, 3] = 0.0
            step = np.eye(4) + A * dt + (A @ A) * (0.5 * dt * dt)
            keep_gust, keep = np.exp(-dt / gust_memory), np.exp(-dt / memory)
            step[3, 3] = keep_gust
            F[:4, :4] = step
            for c in range(4):
                F[4 + c, 4 + c] = keep
            P = F @ P @ F.T
            fresh = gust * gust * (1.0 - keep_gust**2)
            P[3, 3] += fresh
            # The gust that arises within the step already acts on the states.
            for a in range(2):
                P[a, 3] += 0.5 * step[a, 3] * fresh
                P[3, a] += 0.5 * step[a, 3] * fresh
            for c in range(4):
                P[4 + c, 4 + c] += noise[4 + c] ** 2 * (1.0 - keep**2)
            X = F @ X
        c = channel[i]
        h = H[c]
        Ph = P @ h
        variance = h @ Ph + noise[c] ** 2
        root = np.sqrt(variance)
        gain = Ph / variance
        for j in range(k):
            predicted = 0.0
            for s in range(STATES):
                predicted += h[s] * X[s, j]
            innovation = columns[i, j] - predicted
            out[i, j] = innovation / root
            for s in range(STATES):
                X[s, j] += gain[s] * innovation
        for a in range(STATES):
            for b in range(STATES):
                P[a, b] -= gain[a] * Ph[b]
        if variance < 0.1 * _LARGE:
            cost += np.log(variance) + out[i, 0] ** 2
    return cost, out


def packed(air: AirModel) -> FloatArray:
    """Shape (12,), as ``whiten`` takes it."""
    return np.concatenate(
        [air.white, air.coloured, [air.memory_s, air.gust, air.gust_memory_s, air.seen_by_alpha]]
    )


def cost_of(rows: Sequence[Rows], system: FloatArray, air: AirModel) -> float:
    """-2 log likelihood of residuals under an air model, summed over manoeuvres."""
    noise = packed(air)
    total = 0.0
    for r in rows:
        cost, _ = whiten(r.t, r.channel, r.left[:, None], np.append(system, r.speed), noise)
        total += cost
    return total


@dataclass(frozen=True)
class Turbulence:
    """Whether the residuals look like moving air, and how strongly."""

    gain: float
    """Log likelihood that moving air brings over instruments with coloured noise of their own."""
    gust_angle: float
    """Standard deviation of w/V, rad."""
    air: AirModel
    """The likelier of the two."""

    @property
    def present(self) -> bool:
        """Moving air, beyond what noise of instruments explains, and large enough to matter (0.1 deg)."""
        return self.gain > 20.0 and self.gust_angle > 0.0017


def find_turbulence(
    rows: Sequence[Rows], system: FloatArray, white: FloatArray, seen_by_alpha: bool
) -> Turbulence:
    """Fit noise with and without moving air to residuals and compare.

    Parameters
    ----------
    rows
        Residuals of the manoeuvres, offsets removed.
    system
        Z_α, Z_q, M_α, M_q.
    white
        Shape (4,): first guess of the white noise, SI.
    """
    rms = np.array([_rms(rows, c) for c in range(4)])
    white = np.clip(white, 1e-3 * rms + 1e-9, rms + 1e-9)
    colour = np.sqrt(np.maximum(rms**2 - white**2, (0.1 * rms) ** 2))
    still = _descend(rows, system, AirModel(white, colour, 0.3, 0.0, 1.0, float(seen_by_alpha)), False)
    moving = min(
        (
            _descend(
                rows,
                system,
                replace(still[0], coloured=0.3 * still[0].coloured, gust=size, gust_memory_s=1.0),
                True,
            )
            for size in (max(0.7 * rms[ALPHA], 1e-4), max(0.2 * rms[ALPHA], 1e-4))
        ),
        key=lambda found: found[1],
    )
    gain = 0.5 * (still[1] - moving[1])
    return Turbulence(gain, moving[0].gust if gain > 0.0 else 0.0, moving[0] if gain > 0.0 else still[0])


def _rms(rows: Sequence[Rows], channel: int) -> float:
    picked = np.concatenate([r.left[r.channel == channel] for r in rows])
    return float(np.sqrt(np.mean(picked**2))) if len(picked) else 1.0


def _descend(
    rows: Sequence[Rows], system: FloatArray, start: AirModel, moving: bool
) -> tuple[AirModel, float]:
    """Coordinate search in the logarithms of the noise figures, steps halved from a factor of two."""
    x = np.log(np.maximum(packed(start), 1e-12))
    free = [*range(9), 9, 10] if moving else [*range(9)]
    present = {int(c) for r in rows for c in np.unique(r.channel)}
    free = [i for i in free if i >= 8 or i % 4 in present]

    def model(y: FloatArray) -> AirModel:
        v = np.exp(y)
        return AirModel(v[:4], v[4:8], float(np.clip(v[8], 0.02, 5.0)), float(v[9]) if moving else 0.0,
                        float(np.clip(v[10], 0.05, 20.0)), start.seen_by_alpha)  # fmt: skip

    best = cost_of(rows, system, model(x))
    for step in (0.7, 0.35, 0.15):
        for i in free:
            for direction in (step, -step):
                moved = x.copy()
                moved[i] += direction
                cost = cost_of(rows, system, model(moved))
                while cost < best - 0.5:
                    best, x = cost, moved
                    moved = x.copy()
                    moved[i] += direction
                    cost = cost_of(rows, system, model(moved))
    return model(x), best


def rows_of(fits: Mapping[str, ChannelFit], speed: float) -> Rows:
    """Residuals of one manoeuvre's fit, merged in order of time; each channel's mean taken out."""
    t, channel, left = [], [], []
    for c, name in enumerate(CHANNELS):
        if name in fits:
            fit = fits[name]
            t.append(fit.t)
            channel.append(np.full(len(fit.t), c))
            left.append(fit.residual - np.mean(fit.residual))
    times = np.concatenate(t)
    order = np.argsort(times, kind="stable")
    return Rows(times[order], np.concatenate(channel)[order], np.concatenate(left)[order], speed)


def turbulence_in(estimated: Estimate, seen_by_alpha: bool = True) -> Turbulence:
    """Is a fitted manoeuvre's residual the mark of moving air? For the verdict on each manoeuvre."""
    speed = estimated.airspeed_m_s or 20.0
    rows = [rows_of(fits, speed) for fits in estimated.fits]
    white = np.array([_white(estimated, name) for name in CHANNELS])
    return find_turbulence(rows, system_of(estimated), white, seen_by_alpha)


def system_of(estimated: Estimate) -> FloatArray:
    """Z_α, Z_q, M_α, M_q of an estimate, as ``whiten`` takes them before the speed."""
    return np.array([estimated.value(name) for name in ("Z_alpha", "Z_q", "M_alpha", "M_q")])


def _white(estimated: Estimate, name: str) -> float:
    """White part of a channel's residual, from its differences."""
    pieces = [np.diff(fits[name].residual) for fits in estimated.fits if name in fits]
    return float(np.median(np.abs(np.concatenate(pieces))) / 0.6745 / np.sqrt(2.0)) if pieces else 1.0
