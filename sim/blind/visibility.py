"""Structural gap: the part of an effect that no choice of the eight parameters can hide.

Two flights without noise are compared, with and without the effect. Least squares remove the part of their
difference that a short-period model could explain. The short-period model has the eight parameters, and
separate initial states, trim and offsets in each manoeuvre. The response to differing commands is also
removed, because commands are recorded. The structural gap is the residual of this fit over the noise.
"""

from collections.abc import Sequence

import numpy as np

from ..arrays import FloatArray
from ..flight import Sample
from ..linear import ShortPeriod
from ..servo import Calibration

CHANNELS = ("alpha", "q", "a_z", "theta")
LEAD_IN_S = 0.5
SAMPLING_S = 0.02


def structural_gap(
    plain: Sequence[Sample],
    changed: Sequence[Sample],
    model: ShortPeriod,
    sigma: dict[str, float],
    tick_s: float,
) -> float:
    """Return the mean over the channels of (residual difference)² / (noise)², over all manoeuvres.

    Parameters
    ----------
    plain, changed
        Samples of the two flights, tick by tick.
    model
        Short-period parameters of the plain aircraft.
    sigma
        Noise of each channel, SI.
    tick_s
        Time between samples.
    """
    # Fifty samples a second suffice for any rate of the loop.
    every = max(1, round(SAMPLING_S / tick_s))
    plain, changed, tick_s = plain[::every], changed[::every], every * tick_s
    blocks = _maneuvers(plain)
    columns, targets = [], []
    for number, flown in enumerate(blocks):
        before, after = [plain[i] for i in flown], [changed[i] for i in flown]
        shared, own, by_command = _sensitivities(before, after, model, tick_s)
        difference = np.concatenate(
            [
                [
                    getattr(b.reading, name) - getattr(a.reading, name)
                    for a, b in zip(before, after, strict=True)
                ]
                for name in CHANNELS
            ]
        )
        weight = np.concatenate([np.full(len(flown), 1.0 / sigma[name]) for name in CHANNELS])
        local = np.zeros((len(weight), len(blocks) * own.shape[1]))
        local[:, number * own.shape[1] : (number + 1) * own.shape[1]] = own * weight[:, None]
        columns.append(np.hstack([shared * weight[:, None], local]))
        targets.append((difference - by_command) * weight)
    regressors, target = np.vstack(columns), np.concatenate(targets)
    scale = np.sqrt((regressors**2).sum(axis=0)) + 1e-300
    solution, *_ = np.linalg.lstsq(regressors / scale, target, rcond=1e-10)
    rest = target - regressors / scale @ solution
    return float(np.mean(rest**2))


def _maneuvers(samples: Sequence[Sample]) -> list[list[int]]:
    """Return the indices of the samples of each manoeuvre, beginning shortly before its first step."""
    found: dict[float, list[int]] = {}
    for i, sample in enumerate(samples):
        if sample.flying and sample.time_s >= sample.flying.start_s - LEAD_IN_S:
            found.setdefault(sample.flying.start_s, []).append(i)
    return list(found.values())


def _sensitivities(
    flown: Sequence[Sample], changed: Sequence[Sample], model: ShortPeriod, tick_s: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the stacked responses to the six derivatives, to eight nuisance parameters, and to the commands'
    difference.

    Each response is that of one second-order system to a different input. The input is α, q or δe in an
    equation, a constant, an initial state, or a channel offset.
    """
    speed = flown[0].motion.airspeed
    matrix = np.array([[model.Z_alpha, 1 + model.Z_q], [model.M_alpha, model.M_q]])
    states = {name: np.array([getattr(s.motion, name) for s in flown]) for name in ("alpha", "q", "elevator")}
    count = len(flown)
    drives = [
        states["alpha"] - states["alpha"].mean(),
        states["q"],
        states["elevator"] - states["elevator"].mean(),
    ]
    ones, nothing = np.ones(count), np.zeros(count)

    def outputs(into_z: FloatArray, into_m: FloatArray, start: tuple[float, float]) -> FloatArray:
        alpha, q = _respond(matrix, into_z, into_m, start, tick_s)
        alpha_dot = model.Z_alpha * alpha + (1 + model.Z_q) * q + into_z
        theta = np.concatenate([[0.0], np.cumsum(0.5 * (q[1:] + q[:-1]) * tick_s)])
        return np.concatenate([alpha, q, speed * (alpha_dot - q), theta])

    shared = [outputs(drive, nothing, (0.0, 0.0)) for drive in drives]
    shared += [outputs(nothing, drive, (0.0, 0.0)) for drive in drives]
    own = [
        outputs(ones, nothing, (0.0, 0.0)),
        outputs(nothing, ones, (0.0, 0.0)),
        outputs(nothing, nothing, (1.0, 0.0)),
        outputs(nothing, nothing, (0.0, 1.0)),
    ]
    own += [np.concatenate([ones if i == j else nothing for j in range(4)]) for i in range(4)]
    calibration = Calibration()
    command = np.array(
        [
            calibration.deflection(b.pulse_us) - calibration.deflection(a.pulse_us)
            for a, b in zip(flown, changed, strict=True)
        ]
    )
    by_command = outputs(model.Z_delta_e * command, model.M_delta_e * command, (0.0, 0.0))
    return np.column_stack(shared), np.column_stack(own), by_command


def _respond(
    matrix: FloatArray, into_z: FloatArray, into_m: FloatArray, start: tuple[float, float], tick_s: float
) -> tuple[FloatArray, FloatArray]:
    """Solve ẋ = A x + u on the ticks by the trapezium rule, whose second order suffices here."""
    forward = np.eye(2) + 0.5 * tick_s * matrix
    backward = np.linalg.inv(np.eye(2) - 0.5 * tick_s * matrix)
    transition = backward @ forward
    push = 0.5 * tick_s * backward
    drive = np.column_stack([into_z, into_m])
    added = (drive[1:] + drive[:-1]) @ push.T
    (a, b), (c, d) = transition.tolist()
    alpha, q = start
    rows = [(alpha, q)]
    for z, m in added.tolist():
        alpha, q = a * alpha + b * q + z, c * alpha + d * q + m
        rows.append((alpha, q))
    result = np.array(rows)
    return result[:, 0], result[:, 1]
