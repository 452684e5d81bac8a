"""The flight: pilot, servo, air, aircraft and instruments stepped together."""

import math
from collections import deque
from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass

import numpy as np

from . import hangar
from .atmosphere import DrydenTurbulence
from .autopilot import Autopilot, Demand, Pilot, Planned, plan
from .fittings import Fittings, complete
from .loading import DepartureError
from .motion import Controls, Motion
from .scenario import Maneuver, Noise, Scenario
from .sensors import NOISY, ChannelNoise, Reading, ideal
from .servo import Servo

_DEPARTED_RAD_S = 50.0
"""Pitch rate above which the motion counts as departed, rad/s. No aircraft reaches this pitch rate."""


@dataclass(frozen=True)
class Sample:
    """One tick of the loop, with the data for the telemetry."""

    time_s: float
    """Time since the log began, s."""
    reading: Reading
    motion: Motion
    """True motion, which the telemetry does not contain."""
    pulse_us: int
    """Pulse width of the elevator command, us."""
    throttle: float
    aileron: float
    rudder: float
    mode: int
    north_m: float
    east_m: float
    flying: Planned | None
    """Manoeuvre that is being flown; None between manoeuvres."""


class Flight:
    """A scenario with its aircraft, pilot and effects.

    Parameters
    ----------
    scenario
        Scenario to fly.
    fittings
        Effects to add. With None only the scenario's own sections act.
    engine
        Aircraft to fly. None for the scenario's aircraft from the hangar.
    pilot
        Pilot of the aircraft. None for an autopilot with the scenario's plan.
    duration_s
        Duration of the flight, s. None to fly to the end of the plan.
    fresh
        Function that builds the plain aircraft again, for a flight that determines the size of the signals.

    Notes
    -----
    The elevator command becomes a whole pulse width before it flies. With ``input: linear`` the command
    of the next tick is decided at this one and the surface moves to it in a straight line, so that
    SERVO_OUTPUT_RAW read with straight lines between its stamps is exactly what flew; with ``held``
    the command decided at a tick stands until the next, and moves within one integration step.
    """

    def __init__(
        self,
        scenario: Scenario,
        fittings: Fittings | None = None,
        engine: hangar.Aircraft | None = None,
        pilot: Pilot | None = None,
        duration_s: float | None = None,
        fresh: Callable[[Scenario], hangar.Aircraft] = hangar.build,
    ) -> None:
        self.scenario = scenario
        self.engine = engine or fresh(scenario)
        usual = hangar.habits(scenario)
        self.planned = plan(scenario, usual.amplitude_deg, usual.unit_s)
        planned_s = self.planned[-1].end_s if self.planned else scenario.lead_in_s
        self.duration_s = planned_s + scenario.closing_s if duration_s is None else duration_s
        self.calibration = self.engine.calibration
        self._fittings = complete(scenario, fittings or Fittings())
        self._servo = Servo(tuple(self._fittings.mechanisms))
        self._pilot = pilot or Autopilot(
            self.planned, self.engine.trim, self.engine.motion(), self.engine.truth, scenario.augmentation
        )
        self._noise = ChannelNoise(noise_sigma(scenario, fresh), scenario.noise.colour, scenario.seed)
        self._passing = DrydenTurbulence(0.0, 60.0, np.random.default_rng([scenario.seed, 7]))
        self._steps = round(1.0 / (scenario.loop_hz * scenario.step_s))
        self._early_s = max([0.0, *(-skew for skew in self._fittings.skews.values())])
        self._deepest_s = max([0.0, *self._fittings.skews.values()])

    def samples(self) -> Iterator[Sample]:
        """Fly the scenario, and yield a sample at every tick of the loop.

        Raises
        ------
        DepartureError
            The aircraft departs from flight, because its model is unstable.
        """
        dt, period = self.scenario.step_s, self._steps * self.scenario.step_s
        held = self.scenario.input == "held"
        motion = self.engine.motion()
        trim_us = self.calibration.pulse(self.engine.trim.elevator)
        self._servo.reset(self.calibration.deflection(trim_us))
        demand = Demand(
            self.engine.trim.elevator, self.engine.trim.throttle, 0.0, 0.0, self._pilot.mode(0.0), 0.0
        )
        pulse, north, east = trim_us, 0.0, 0.0
        past: deque[tuple[float, Reading]] = deque()
        waiting: deque[Sample] = deque()
        reading = self._read(motion, 0.0)
        # Without instruments that remember, and without skews, only the loop's tick reads.
        often = bool(self._fittings.sensors or self._fittings.skews)
        ticks = math.ceil(self.duration_s / period - 1e-9)
        for tick in range(ticks + math.ceil(self._early_s / period)):
            now = tick * period
            following = self._pilot.demand(now if held else now + period, motion, period)
            if held:
                pulse, demand = self.calibration.pulse(following.elevator), following
            for effect in self._fittings.plant:
                effect.apply(now, motion, self.engine)
            waiting.append(
                Sample(
                    now, copy(reading), motion, pulse, demand.throttle, demand.aileron, demand.rudder,
                    self._pilot.mode(now), north, east, self._pilot.current(now),
                )
            )  # fmt: skip
            if self._fittings.skews:
                past.append((now, copy(reading)))
            next_pulse = self.calibration.pulse(following.elevator)
            begin, end = self.calibration.deflection(pulse), self.calibration.deflection(next_pulse)
            for step in range(1, self._steps + 1):
                command = end if held else begin + (end - begin) * step / self._steps
                motion = self._step(command, following, now + step * dt, motion, dt)
                if often or step == self._steps:
                    reading = self._read(motion, dt)
                if self._fittings.skews and step < self._steps:
                    past.append((now + step * dt, copy(reading)))
            if not abs(motion.q) < _DEPARTED_RAD_S:
                raise DepartureError(
                    [f"the motion grows without bound {now:.1f} s after the start: the aircraft is unstable"]
                )
            pulse, demand = next_pulse, following
            ground = motion.airspeed * math.cos(motion.theta - motion.alpha) * period
            north += ground + self.scenario.air.wind_north_m_s * period
            east += self.scenario.air.wind_east_m_s * period
            while waiting and waiting[0].time_s + self._early_s <= now + period - dt:
                sample = waiting.popleft()
                if sample.time_s >= self.duration_s - 1e-9:
                    return
                self._skew(sample, past)
                self._noise.add(sample.reading)
                yield sample

    def _step(self, command: float, demand: Demand, time_s: float, motion: Motion, dt: float) -> Motion:
        surface = self._servo.step(command, dt)
        up = head = extra_cl = extra_cm = 0.0
        for air in self._fittings.air:
            gust_up, gust_head = air.step(time_s, motion, dt)
            up += gust_up
            head += gust_head
        if demand.turbulence > 0.0:
            self._passing.sigma = demand.turbulence
            gust_up, gust_head = self._passing.step(motion.airspeed, dt)
            up += gust_up
            head += gust_head
        for force in self._fittings.forces:
            cl, cm = force.step(time_s, motion, dt)
            extra_cl += cl
            extra_cm += cm
        controls = Controls(
            surface, demand.throttle, demand.aileron, up, head, extra_cl, extra_cm, demand.rudder
        )
        return self.engine.step(controls, dt)

    def _read(self, motion: Motion, dt: float) -> Reading:
        reading = ideal(motion, self._fittings.accelerometer_arm_m)
        for effect in self._fittings.sensors:
            effect.apply(motion, reading, dt)
        return reading

    def _skew(self, sample: Sample, past: deque[tuple[float, Reading]]) -> None:
        """Replace each skewed channel by its value ``skew`` seconds before the sample."""
        if not self._fittings.skews:
            return
        while len(past) > 1 and past[1][0] <= sample.time_s - self._deepest_s - 0.05:
            past.popleft()
        dt = self.scenario.step_s
        for channel, skew in self._fittings.skews.items():
            at = (sample.time_s - skew - past[0][0]) / dt
            index = min(max(int(at), 0), len(past) - 2)
            share = min(max(at - index, 0.0), 1.0)
            before, after = getattr(past[index][1], channel), getattr(past[index + 1][1], channel)
            setattr(sample.reading, channel, before + (after - before) * share)


def noise_sigma(
    scenario: Scenario, fresh: Callable[[Scenario], hangar.Aircraft] = hangar.build
) -> dict[str, float]:
    """Return the standard deviation of each channel's noise, SI units.

    Percentages refer to the channel's deviation from trim, as a largest value or a standard deviation. The
    deviation is taken from the scenario's first manoeuvre, flown without noise, effects and turbulence.
    """
    noise = scenario.noise
    sigma = {
        "alpha": math.radians(noise.alpha_deg),
        "q": math.radians(noise.pitch_rate_deg_s),
        "theta": math.radians(noise.pitch_deg),
        "a_x": noise.accelerometer_m_s2,
        "a_z": noise.accelerometer_m_s2,
        "airspeed": noise.airspeed_m_s,
        "climb": noise.climb_m_s,
    }
    if noise.percent > 0.0 and scenario.maneuvers:
        first = scenario.maneuvers[0]
        plain = Maneuver(
            first.input, amplitude_deg=first.amplitude_deg, unit_s=first.unit_s, free_s=first.free_s
        )
        quiet = Scenario(
            aircraft=scenario.aircraft,
            engine=scenario.engine,
            airframe=scenario.airframe,
            airspeed_m_s=scenario.airspeed_m_s,
            height_m=scenario.height_m,
            amplitude_deg=scenario.amplitude_deg,
            unit_s=scenario.unit_s,
            free_s=scenario.free_s,
            speed=scenario.speed,
            augmentation=scenario.augmentation,
            lead_in_s=1.0,
            maneuvers=(plain,),
            noise=Noise(),
        )
        signal = [
            s for s in Flight(quiet, fresh=fresh).samples() if s.flying and s.time_s >= s.flying.start_s
        ]
        for name in NOISY:
            values = np.array([getattr(sample.reading, name) for sample in signal])
            size = np.abs(values - values[0]).max() if noise.of == "peak" else values.std()
            sigma[name] += noise.percent / 100.0 * float(size)
    return {name: value for name, value in sigma.items() if value > 0.0}
