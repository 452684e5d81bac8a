"""Response of a servo to one piece of its command: lag and rate limit, play, or dry friction."""

import numpy as np

from advisor.process.compiled import kernel

ARRIVED_RAD = 1e-9
"""Deflection error in rad below which the servo has reached its command."""
_PARTS = 8
"""Largest number of parts of one command piece: at the rate limit, lagging, and at the opposite limit."""


@kernel()
def through_servo(
    servo: float, link: float, begin: float, end: float, dt: float, tau: float, most: float, play: float
) -> tuple[float, float, float]:
    """Return servo and linkage at the end of a linear command piece, and the deflection's integral.

    The servo moves by (command − servo)/τ, but no faster than ``most`` rad/s. The motion in a command piece
    therefore consists of a few exponential and linear parts. The linkage rests until the servo has crossed
    its play.
    """
    slope, left, command, area = (end - begin) / dt, dt, begin, 0.0
    way, limit = np.sign(slope), most * tau
    for _ in range(_PARTS):
        error = command - servo
        outrun = abs(slope) > most and way * error >= limit - ARRIVED_RAD
        if outrun or abs(error) > limit + ARRIVED_RAD:
            side = way if outrun else np.sign(error)
            closing = most - side * slope
            time = left if closing <= 0.0 else min(left, max(side * error - limit, 0.0) / closing)
            to = servo + side * most * time
            swept = 0.5 * (servo + to) * time
        else:
            settled, time = slope * tau, left
            if abs(slope) > most and tau > 0.0:
                time = min(left, -tau * np.log((way * limit - settled) / (error - settled)))
            trail = (error - settled) * np.exp(-time / tau) if tau > 0.0 else 0.0
            to = command + slope * time - settled - trail
            swept = (command + 0.5 * slope * time) * time - tau * (to - servo)
        if play > 0.0:
            before, link = link, min(max(link, to - play), to + play)
            share = (link - before) / (to - servo) if link != before else 0.0
            swept = (before + 0.5 * (link - before) * share) * time
        area += swept
        servo, command, left = to, command + slope * time, left - time
        if left <= 0.0:
            break
    return servo, link, area


@kernel()
def through_friction(
    link: float, way: float, begin: float, end: float, dt: float, holds: float, drags: float, tau: float
) -> tuple[float, float, float]:
    """Return surface, direction of sliding and integral of the deflection after a linear command.

    The friction model is a position loop with dry friction. At rest the surface holds until the command is
    ``holds`` rad away. A sliding surface lags by ``tau`` s behind a point ``drags`` rad short of the command,
    and rests where its direction would reverse.
    """
    slope, left, command, area = (end - begin) / dt, dt, begin, 0.0
    tau = max(tau, 1e-3)
    for _ in range(_PARTS):
        if way == 0.0:
            side = np.sign(command - link)
            if abs(command - link) > holds:
                way, time = side, 0.0
            elif slope == 0.0:
                time = left
            else:
                time = (link + np.sign(slope) * holds - command) / slope
                way = np.sign(slope) if time < left else 0.0
                time = min(time, left)
            area += link * time
        else:
            error, settled = command - way * drags - link, slope * tau
            way_at, time = way, left
            if way * error <= 0.0:
                way, time = 0.0, 0.0
            elif way * settled < 0.0:
                time = tau * np.log((settled - error) / settled)
                way = way if time > left else 0.0
                time = min(time, left)
            if time > 0.0:
                to = link + settled * time / tau + (error - settled) * (1.0 - np.exp(-time / tau))
                area += (command - way_at * drags + 0.5 * slope * time) * time - tau * (to - link)
                link = to
        command, left = command + slope * time, left - time
        if left <= 0.0:
            break
    if left > 0.0:
        area += link * left
    return link, way, area
