"""From the command to the surface: one step of the servo, with everything that may be wrong with it."""

from typing import NamedTuple

import numba
import numpy as np


class Servo(NamedTuple):
    """Lags in s, angles in rad; zero means perfect."""

    lag_s: float = 0.0
    """What the aircraft file states."""
    delay_s: float = 0.0
    added_lag_s: float = 0.0
    added_delay_s: float = 0.0
    rate_limit: float = 0.0
    play: float = 0.0
    """Half-width of the linkage's play."""
    deadband: float = 0.0
    """Half-width about ``neutral`` within which a command moves nothing."""
    neutral: float = 0.0
    notch: float = 0.0
    """Half-width of a worn place of the feedback potentiometer, around ``notch_at``."""
    notch_at: float = 0.0
    upward_lag_s: float = 0.0
    """Added lag while the trailing edge goes up, against the load."""
    echo: float = 0.0
    """Share of an old command in what the servo hears."""
    echo_s: float = 0.0
    brownout: float = 0.0
    """Commanded rate [rad/s] at which the supply collapses and the servo stands for ``brownout_s``."""
    brownout_s: float = 0.0


@numba.njit(cache=True)
def heard(commands, k, step, servo):  # type: ignore[no-untyped-def]
    """The command as it reaches the servo: late, and with the echo of an older one."""
    late = earlier(commands, k, (servo.delay_s + servo.added_delay_s) / step)
    if servo.echo > 0.0:
        old = earlier(commands, k, (servo.delay_s + servo.added_delay_s + servo.echo_s) / step)
        late += servo.echo * (old - late)
    if servo.deadband > 0.0:
        off = late - servo.neutral
        late = servo.neutral + np.sign(off) * max(abs(off) - servo.deadband, 0.0)
    if servo.notch > 0.0 and abs(late - servo.notch_at) < servo.notch:
        late = servo.notch_at + np.sign(late - servo.notch_at) * servo.notch
    return late


@numba.njit(cache=True)
def earlier(commands, k, steps):  # type: ignore[no-untyped-def]
    """Value of a record some steps ago, linear between steps."""
    at = max(k - steps, 0.0)
    low = int(at)
    return commands[low] + (at - low) * (commands[min(low + 1, k)] - commands[low])


@numba.njit(cache=True)
def moved(state, commands, k, step, servo):  # type: ignore[no-untyped-def]
    """Surface after a step; ``state``: horn, own lag, added lag, surface, time to stand."""
    wanted = heard(commands, k, step, servo)
    if servo.brownout > 0.0:
        if state[4] <= 0.0 and k > 0 and abs(commands[k] - commands[k - 1]) > servo.brownout * step:
            state[4] = servo.brownout_s
        elif state[4] > 0.0:
            state[4] -= step
            wanted = state[0]
    if servo.rate_limit > 0.0:
        most = servo.rate_limit * step
        wanted = state[0] + min(max(wanted - state[0], -most), most)
    horn, own = state[0], state[1]
    state[0] = wanted
    state[1] = follow(state[1], horn, wanted, step, servo.lag_s)
    lag = servo.added_lag_s
    if servo.upward_lag_s > 0.0 and state[1] < state[2]:
        lag += servo.upward_lag_s
    state[2] = follow(state[2], own, state[1], step, lag)
    state[3] = min(max(state[3], state[2] - servo.play), state[2] + servo.play)
    return state[3]


@numba.njit(cache=True)
def follow(value: float, before: float, now: float, step: float, lag_s: float) -> float:
    """Answer of a first-order lag to an input that moves from ``before`` to ``now`` within a step."""
    if lag_s <= 0.0:
        return now
    middle = 0.5 * (before + now)
    return middle + (value - middle) * np.exp(-step / lag_s)
