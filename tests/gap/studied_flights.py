"""Flights of the gap's studies: aircraft of the third coding, with what is wrong on board."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.signal import lfilter, lsim

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.analysis.gap_flights import maneuvers_of
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import read_scenario
from tests.flights import SHIPPED
from tests.gap.generator import Setup, fly

Flown = list[Maneuver]
Change = Callable[[Channel], Channel]

MODEL = dict(zip(PARAMETERS, (0.04, -4.3, -0.03, -0.28, 0.0, -37.0, -4.8, -52.0), strict=True))
AIR = {"gust_std": 0.12, "coloured": 0.5, "jitter": 0.004, "speed_change": 0.03, "seed": 37}
"""Gusts, noise with a memory, stamps that jitter and a speed that differs."""
BANKS = (-8.0, 14.0, 3.0, -20.0, 25.0)
SERVO = Elevator(calibration=((1000.0, 25.0), (1500.0, 0.0), (2000.0, -25.0)), lag_s=0.14)
"""The servo of the recorded flights of ArduPlane."""


def six(switches: Mapping[str, float] | None = None, **changes: Any) -> Setup:
    """Return six manoeuvres in still air."""
    return Setup(**{"maneuvers": 6, "switches": dict(switches or {}), **changes})


def hard(switches: Mapping[str, float] | None = None, **changes: Any) -> Setup:
    """Return six manoeuvres in moving air, with noise and stamps of a real link."""
    return six(switches, **{**AIR, **changes})


def reading(setup: Setup, channel: str, change: Change) -> Callable[[], Flown]:
    """Return the flight with another instrument."""

    def flown() -> Flown:
        return [replace(m, channels={**m.channels, channel: change(m.channels[channel])}) for m in fly(setup)]

    return flown


def read(change: Callable[[Any], Any]) -> Change:
    """Return an instrument that reads another value."""
    return lambda c: replace(c, y=change(c.y))


def jumping() -> Change:
    rng = np.random.default_rng(22)
    return lambda c: replace(
        c, y=c.y + 0.03 * (np.convolve(rng.random(len(c)) < 0.006, np.ones(4), mode="same") > 0.0)
    )


def stuck(c: Channel) -> Channel:
    """Return the channel of a vane that sticks until the air has turned by 0.012 rad."""
    shown = [c.y[0]]
    for value in c.y:
        shown.append(value if abs(value - shown[-1]) > 0.012 else shown[-1])
    return replace(c, y=np.array(shown[1:]))


def rubbed(angles: Any, half_play: float) -> Any:
    """Return the angles of a pointer that follows once the vane has run ahead by half the play."""
    shown = [angles[0]]
    for angle in angles[1:]:
        ahead = angle - shown[-1]
        shown.append(shown[-1] + np.sign(ahead) * max(abs(ahead) - half_play, 0.0))
    return np.array(shown)


def through_vane(setup: Setup, seen: Callable[[Any], Any]) -> Callable[[], Flown]:
    """Return the flight with another vane, and its noise behind it."""
    rng = np.random.default_rng(5)

    def noisy(c: Channel) -> Channel:
        return replace(c, y=seen(c.y) + setup.noise * np.ptp(c.y) / 2.0 * rng.standard_normal(len(c)))

    return reading(replace(setup, noise=0.1 * setup.noise), "alpha", noisy)


def wandering(channel: str, share: float, memory_s: float, others: float = 0.0) -> Callable[[], Flown]:
    """Return a flight in which an instrument wanders by a share of its largest motion, with a memory."""
    rng = np.random.default_rng(4)

    def wanders(c: Channel, share: float) -> Channel:
        size = share * np.max(np.abs(c.y - c.y[0]))
        decay = np.exp(-np.median(np.diff(c.t)) / memory_s)
        course = lfilter([size * np.sqrt(1 - decay**2)], [1, -decay], rng.standard_normal(len(c.t)))
        return replace(c, y=c.y + course)

    def flown() -> Flown:
        shares = dict.fromkeys(("alpha", "q", "a_z", "theta"), others) | {channel: share}
        return [
            replace(m, channels=m.channels | {n: wanders(m.channels[n], s) for n, s in shares.items()})
            for m in fly(Setup(seed=12))
        ]

    return flown


def through_filter(late_s: float, shape: float) -> Change:
    """Return an instrument behind a filter 1/(1 + T p + c T² p²)."""

    def passed(c: Channel) -> Channel:
        t, bias = np.arange(c.t[0], c.t[-1] + 1e-9, 0.002), np.median(c.y[:20])
        system = [1.0], [max(shape, 1e-4) * late_s**2, late_s, 1.0]
        y = lsim(system, np.interp(t, c.t, c.y) - bias, t - t[0])[1]
        return replace(c, y=bias + np.interp(c.t, t, y))

    return passed


def saturating() -> Flown:
    """Return a flight whose gyro reads at most 15 % of the largest rate."""
    flown = fly(six(seed=21))
    most = 0.15 * max(float(np.max(np.abs(m.channels["q"].y))) for m in flown)
    return [
        replace(m, channels={**m.channels, "q": read(lambda y: np.clip(y, -most, most))(m.channels["q"])})
        for m in flown
    ]


def feeling(setup: Setup, felt: Callable[[Any], Any]) -> Callable[[], Flown]:
    """Return a flight whose gyro feels the acceleration."""

    def flown() -> Flown:
        changed = []
        for m in fly(setup):
            q, a_z = m.channels["q"], m.channels["a_z"]
            wrong = replace(q, y=q.y + felt(np.interp(q.t, a_z.t, a_z.y) + 9.81))
            changed.append(replace(m, channels={**m.channels, "q": wrong}))
        return changed

    return flown


def weakened(setup: Setup) -> Callable[[], Flown]:
    """Return a flight whose last two elevator commands move the surface by two thirds."""

    def flown() -> Flown:
        weak = reading(setup, "elevator", lambda c: replace(c, y=1.5 * c.y - 0.5 * c.y[0]))()
        return [*fly(setup)[:4], *weak[4:]]

    return flown


def dead_band_about_each_trim() -> Flown:
    above = iter((0.0, 0.03, -0.02, 0.01, -0.03, 0.02))
    return reading(six({"deadband": 0.012}), "elevator", lambda c: replace(c, y=c.y + next(above)))()


def lagging_more_and_more(setup: Setup) -> Callable[[], Flown]:
    """Return a flight whose vane lags a third longer in the end."""
    lags_s = np.linspace(0.04, 0.053, 8)
    return lambda: [fly(replace(setup, switches={"vane_lag": lag}))[i] for i, lag in enumerate(lags_s)]


def logged_seldom() -> Flown:
    """Return a flight whose command is logged ten times a second, each manoeuvre's at other moments."""
    first = iter(range(6))

    def seldom(c: Channel) -> Channel:
        k = next(first) % 5
        return replace(c, t=c.t[k::5], y=c.y[k::5])

    return reading(six(seed=5), "elevator", seldom)()


def estimated(maneuvers: Flown, late_s: float = 0.025) -> Flown:
    """Return the manoeuvres with an angle of attack of 10 Hz, late and smooth, from an estimator."""
    own = []
    for m in maneuvers:
        alpha = m.channels["alpha"]
        smooth = np.convolve(np.pad(alpha.y, 2, mode="edge"), np.full(5, 0.2), mode="valid")[::5]
        source = {"source": "XKF1, XKF2", "provenance": "derived"}
        alpha = replace(alpha, t=alpha.t[::5] + late_s, y=smooth, **source)
        own.append(replace(m, channels={**m.channels, "alpha": alpha}))
    return own


def simulated(scenario: str) -> Callable[[], Flown]:
    """Return the manoeuvres of the bundled simulator."""

    def flown() -> Flown:
        with TemporaryDirectory() as folder:
            file, log = Path(folder, "flown.yaml"), Path(folder, "flown.tlog")
            file.write_text(scenario)
            record(flight_of(read_scenario(file)), log)
            return list(maneuvers_of([log], Aircraft()).maneuvers)

    return flown


@cache
def arduplane(log: str = "arduplane-calm", elevator: Elevator = SERVO) -> Flown:
    """Return the manoeuvres that ArduPlane recorded."""
    return list(maneuvers_of([SHIPPED / f"{log}.tlog"], Aircraft(elevator=elevator)).maneuvers)


def put_into(channel: str, change: Change) -> Callable[[], Flown]:
    """Return ArduPlane's calm flight with one of its channels changed."""
    return lambda: [
        replace(m, channels={**m.channels, channel: change(m.channels[channel])}) for m in arduplane()
    ]


def later(by_s: float) -> Change:
    return lambda c: replace(c, t=c.t + by_s)


def at_airspeed(share: float) -> Callable[[], Flown]:
    """Return a flight at sea level whose air speed reads a share of the true one."""

    def flown() -> Flown:
        speeds = []
        for m in fly(six(speed_change=0.06, seed=53)):
            true = m.channels["airspeed"]
            indicated = {
                "airspeed": replace(true, y=share * true.y),
                "altitude": replace(true, y=0.0 * true.y),
            }
            speeds.append(replace(m, channels=m.channels | indicated))
        return speeds

    return flown


def noisy_speed() -> Flown:
    """Return a flight with the air speed of a pressure port: seldom, and with correlated noise."""
    rng = np.random.default_rng(7)

    def noisy(c: Channel) -> Channel:
        t = np.arange(c.t[0], c.t[-1], 0.2)
        noise = lfilter([np.sqrt(0.75)], [1.0, -0.5], rng.standard_normal(len(t)))
        return replace(c, t=t, y=np.interp(t, c.t, c.y) + 0.3 * noise)

    return reading(six(seed=71), "airspeed", noisy)()


def cut_short() -> Flown:
    """Return a flight of two effects in which two manoeuvres end three seconds early."""
    flown = fly(six({"vane_lag": 0.06, "cl_a2": 12.0}, seed=4))
    for k in (1, 4):
        end = flown[k].span.end_s - 3.0
        channels = {n: c.cut(-np.inf, end - 1e-9) for n, c in flown[k].channels.items()}
        flown[k] = replace(flown[k], span=replace(flown[k].span, end_s=end), channels=channels)
    return flown
