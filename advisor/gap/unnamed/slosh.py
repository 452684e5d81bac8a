"""Something that hangs in the aircraft and swings when it pitches: fuel, a load on a sling, a loose battery.

A mass on a spring, hardly damped, is pulled by the pitch acceleration that is known, and its moment on the
aircraft, in phase with its place and with its speed, has a response that is known, too. So little of it is
needed to be seen that moving air, wrong numbers or a low-order filter take up the rest of it unnoticed.
"""

from collections.abc import Sequence

import numpy as np
from scipy import fft

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.linear import pulse_response
from advisor.gap.fitting.normal import solved
from advisor.gap.fitting.problem import Problem, row_weights
from advisor.gap.fitting.step import factor
from advisor.gap.noise.probes import DYNAMIC
from advisor.gap.records.flights import Flight
from advisor.gap.simulator.layout import OUTPUTS
from advisor.gap.unnamed.leftover import Leftover, instruments_of, noise_of

_HZ = np.geomspace(0.2, 3.0, 25)
"""Frequencies that are tried; a battery that is loose, a tank of one metre or five, a sling lie between."""
_DAMPING = 0.05
"""Damping ratio that is tried: wide enough that no frequency between two of these is missed ..."""
_DAMPINGS = (0.02, 0.05, 0.1)
"""... and those tried where something was found."""
_GAIN, _GAIN_FILTERED = 45.0, 135.0
"""Log likelihood that it must bring: what models leave of other things brings 20. In records that were
filtered on the ground edges ring as well."""
_WIDTH, _ABOVE = 3, 4.0
"""Steps of frequency to either side that a resonance shows in, and by how much it exceeds all others: moving
air brings as much by chance here and there."""
_SWINGS, _FEW = 2.5, 2 * _WIDTH + 3
"""Swings of a record, at least: what is slower may drift; and frequencies that one stands out of."""
_VISIBLE = 0.03
"""Power of its response, beside the instruments' noise, from which on there is something to explain."""


def sloshing(problem: Problem, last: Fitted) -> Leftover | None:
    """A mass that the pitching sets swinging, with a note that says how fast; None without one."""
    noise = noise_of(problem)
    # A record of a few swings does not tell frequencies apart that are nearer than one over its length.
    resolved = 1.0 / float(np.median([flight.duration_s for flight in problem.flights.flights]))
    tried = _HZ[_SWINGS * resolved < _HZ]
    if len(tried) < _FEW:
        return None
    gains = np.array([gain for gain, *_ in _gains(problem, last, noise, [(hz, _DAMPING) for hz in tried])])
    at = int(np.argmax(gains))
    hz, between = float(tried[at]), float(_HZ[1] / _HZ[0])
    near = (np.abs(np.log(tried / hz)) < (_WIDTH + 0.5) * np.log(between)) | (np.abs(tried - hz) < resolved)
    if at in (0, len(gains) - 1) or gains[at] < _ABOVE * np.max(gains[~near]):
        return None
    finer = hz * between ** np.array([-0.67, -0.33, 0.0, 0.33, 0.67])
    fine = _gains(problem, last, noise, [(float(f), z) for f in finer for z in _DAMPINGS])
    gain, share, hz, visible = max(fine, key=lambda trial: trial[0])
    least = _GAIN_FILTERED if problem.flights.alpha_is_smoothed else _GAIN
    if gain < least or visible < _VISIBLE:
        return None
    note = (
        f"Once set off, it swings, {hz:.2g} times a second: a mass that hangs in the aircraft, as fuel does."
    )
    return Leftover("moment_equation", share, (("moment_equation", 1.0),), note=note)


def _gains(
    problem: Problem, last: Fitted, noise: FloatArray, tried: Sequence[tuple[float, float]]
) -> list[tuple[float, float, float, float]]:
    """For each frequency and damping ratio: log likelihood, share explained, the frequency, and power.

    All shared numbers of the model and each manoeuvre's own are free beside it. The power is that of the
    response over that of the instruments' noise.
    """
    p = problem.driving(last.point)
    shared = last.linear[0].shared.shape[1]
    columns = 2 * len(tried)
    gram = np.zeros((shared + columns + 1,) * 2)
    squares, count = np.zeros((columns, columns)), 0
    per_row = 1.0 / np.maximum(instruments_of(problem), 1e-12)
    for i, flight in enumerate(problem.flights.flights):
        seen = problem.read_grids(flight, _responses(problem, flight, p[i], tried), p[i])
        w, linear = row_weights(problem, i, 1.0 / noise)[:, None], last.linear[i]
        free = np.column_stack([linear.shared, problem.innovations(i, seen), last.innovations[i]]) * w
        A = linear.own * w
        AF = A.T @ free
        gram = gram + free.T @ free - AF.T @ solved(factor(A, linear.prior), AF)
        loud = seen * row_weights(problem, i, per_row)[:, None]
        squares, count = squares + loud.T @ loud, count + len(seen)
    pull, _ = problem.pull(last.point)
    model, across = gram[:shared, :shared] + np.diag(pull), gram[:shared, shared:]
    # Numbers of which this flight says nothing stay put.
    size = np.sqrt(np.maximum(np.diag(model), 1e-300))
    model, across = model / np.outer(size, size) + 1e-9 * np.eye(shared), across / size[:, None]
    rest = gram[shared:, shared:] - across.T @ np.linalg.solve(model, across)
    found = []
    for number, (hz, _) in enumerate(tried):
        pair = slice(2 * number, 2 * number + 2)
        sizes = np.linalg.lstsq(rest[pair, pair], rest[pair, -1], rcond=1e-10)[0]
        gain = 0.5 * float(sizes @ rest[pair, -1])
        power = float(sizes @ squares[pair, pair] @ sizes) / count
        found.append((gain, min(2.0 * gain / float(rest[-1, -1]), 1.0), hz, power))
    return found


def _responses(
    problem: Problem, flight: Flight, p: FloatArray, tried: Sequence[tuple[float, float]]
) -> list[FloatArray]:
    """Two series on the grid for each mass: the response to a moment with its place, and with its speed."""
    q = problem.fly(flight, p)[OUTPUTS.index("q")]
    pulled = np.gradient(q, flight.h)
    points = fft.next_fast_len(2 * len(q), real=True)
    pulse = pulse_response(problem, flight, p, DYNAMIC["moment_equation"])
    turned = fft.rfft(pulse, points) * fft.rfft(pulled, points) * flight.h**2
    t = np.arange(len(q)) * flight.h
    swung: list[FloatArray] = []
    for hz, damping in tried:
        ringing = np.exp((1j * np.sqrt(1.0 - damping**2) - damping) * 2.0 * np.pi * hz * t)
        swung += [ringing.imag, ringing.real]
    return [fft.irfft(turned * fft.rfft(course, points), points)[:, : len(q)] for course in swung]
