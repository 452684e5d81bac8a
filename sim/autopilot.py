"""Control of the aircraft: attitude hold between manoeuvres, and the test input during manoeuvres."""

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from .hand import by_hand
from .linear import ShortPeriod
from .maneuvers import Input, elevator_input
from .motion import Controls, Motion
from .scenario import Augmentation, Maneuver, Scenario

MANUAL, FBWA, CRUISE = 0, 5, 7
"""ArduPlane's mode numbers, as in HEARTBEAT.custom_mode."""


class Demand(NamedTuple):
    """Demanded controls for the next tick of the loop."""

    elevator: float
    """Elevator demand before its conversion to a pulse width, rad."""
    throttle: float
    aileron: float
    rudder: float
    mode: int
    turbulence: float
    """Standard deviation of the scenario's additional turbulence at this time, m/s."""


BANDWIDTH_RAD_S = 0.8
"""Bandwidth of the attitude hold, rad/s."""
_PITCH_PER_STICK = 3.0
"""Demanded pitch angle per stick in FBWA, as a multiple of the deflection in MANUAL."""


@dataclass(frozen=True)
class Planned:
    """A manoeuvre with its time in seconds since the log began."""

    maneuver: Maneuver
    input: Input
    manual_from_s: float
    start_s: float
    end_s: float


def plan(scenario: Scenario, amplitude_deg: float, unit_s: float) -> tuple[Planned, ...]:
    """Return the scenario's manoeuvres with their times. ``amplitude_deg`` and ``unit_s`` are the aircraft's
    usual values."""
    planned = []
    now = scenario.lead_in_s
    for number, maneuver in enumerate(scenario.maneuvers):
        amplitude = math.radians(maneuver.amplitude_deg or scenario.amplitude_deg or amplitude_deg)
        unit = maneuver.unit_s or scenario.unit_s or unit_s
        stick = by_hand(maneuver, amplitude, unit, [scenario.seed, number])
        start = now + (scenario.settling_s if maneuver.settling_s is None else maneuver.settling_s)
        end = start + stick.duration_s + (scenario.free_s if maneuver.free_s is None else maneuver.free_s)
        planned.append(Planned(maneuver, stick, now, start, end))
        now = end + (scenario.gap_s if maneuver.gap_s is None else maneuver.gap_s)
    return tuple(planned)


class Pilot(Protocol):
    """Interface of a pilot or autopilot that moves the controls."""

    def demand(self, time_s: float, motion: Motion, period_s: float) -> Demand:
        """Return the controls at ``time_s``, computed from ``motion`` one tick earlier."""
        ...

    def current(self, time_s: float) -> Planned | None:
        """Return the manoeuvre flown at ``time_s``, counted from the change to MANUAL to the change back."""
        ...

    def mode(self, time_s: float) -> int:
        """Return the flight mode at ``time_s``."""
        ...


class Autopilot:
    """Autopilot with attitude, height, speed and bank loops, and a pilot who flies the plan."""

    def __init__(
        self,
        planned: tuple[Planned, ...],
        trim: Controls,
        start: Motion,
        model: ShortPeriod,
        augmentation: Augmentation | None = None,
    ) -> None:
        self._augmentation = augmentation or Augmentation()
        self._planned = planned
        self._trim = trim
        self._start = start
        # Gains scaled by the aircraft's own stiffness, lift slope and control power hold any aircraft steady.
        # They are small, so that servo lags and delays do not upset the loop.
        power, squared = abs(model.M_delta_e), model.frequency() ** 2
        self._stiffness = min(0.4, BANDWIDTH_RAD_S / max(abs(model.Z_alpha), 1e-3)) * squared / power
        self._damping = 0.2 * model.frequency() / power
        self._settled_elevator = trim.elevator
        self._settled_throttle = trim.throttle
        self._integral = self._power = 0.0

    def current(self, time_s: float) -> Planned | None:
        """Return the manoeuvre flown at ``time_s``, counted from the change to MANUAL to the change back."""
        for planned in self._planned:
            if planned.manual_from_s <= time_s < planned.end_s:
                return planned
        return None

    def mode(self, time_s: float) -> int:
        """Return the flight mode at ``time_s``."""
        planned = self.current(time_s)
        if planned is None:
            return CRUISE
        return FBWA if planned.maneuver.mode == "FBWA" else MANUAL

    def _next(self, time_s: float) -> Maneuver | None:
        """Return the manoeuvre whose speed, height and bank are to be reached."""
        for planned in self._planned:
            if time_s < planned.end_s:
                return planned.maneuver
        return None

    def demand(self, time_s: float, motion: Motion, period_s: float) -> Demand:
        """Return the controls at ``time_s``, computed from ``motion`` one tick earlier."""
        planned = self.current(time_s)
        upcoming = self._next(time_s)
        lead = planned is not None or any(
            0.0 < p.manual_from_s - time_s < 4.0 and p.maneuver.bank_deg for p in self._planned
        )
        bank = math.radians(upcoming.bank_deg) if upcoming and lead else 0.0
        aileron = min(max(1.2 * (bank - motion.phi) - 0.25 * motion.p, -0.6), 0.6)
        if planned is None:
            return self._hold(motion, upcoming, aileron, period_s)
        maneuver, since = planned.maneuver, time_s - planned.start_s
        if maneuver.mode == "FBWA":
            asked = _PITCH_PER_STICK * planned.input.pull(since)
            return self._hold(motion, upcoming, aileron, period_s, asked)._replace(mode=FBWA)
        # Aileron and rudder doublets last one unit and begin with the elevator.
        swing = elevator_input("doublet", 1.0, planned.input.duration_s / 7.0).pull(since)
        throttle = self._settled_throttle + (maneuver.throttle_change if since >= -1e-9 else 0.0)
        return Demand(
            self._settled_elevator
            - planned.input.pull(since)
            - math.radians(maneuver.trim_off_deg)
            + self._augmented(motion),
            min(max(throttle, 0.0), 1.0),
            min(max(aileron + maneuver.aileron * swing, -1.0), 1.0),
            maneuver.rudder * swing,
            MANUAL,
            maneuver.turbulence_m_s,
        )

    def _augmented(self, motion: Motion) -> float:
        """Return the elevator deflection that the stability augmentation adds to the pilot's."""
        off = motion.alpha - self._start.alpha
        return self._augmentation.alpha * off + self._augmentation.pitch_rate * motion.q

    def _hold(
        self, motion: Motion, upcoming: Maneuver | None, aileron: float, period_s: float, asked: float = 0.0
    ) -> Demand:
        airspeed = (upcoming.airspeed_m_s if upcoming else None) or self._start.airspeed
        height = self._start.height if upcoming is None or upcoming.height_m is None else upcoming.height_m
        climb = min(max(0.1 * (height - motion.height) / motion.airspeed, -0.05), 0.05)
        off = motion.theta - self._start.theta - climb - asked
        self._integral = min(max(self._integral + 0.1 * off * period_s, -0.2), 0.2)
        elevator = self._trim.elevator + self._stiffness * (off + self._integral) + self._damping * motion.q
        slow = airspeed - motion.airspeed
        self._power = min(max(self._power + 0.03 * slow * period_s, -0.5), 0.5)
        throttle = min(max(self._trim.throttle + 0.1 * slow + self._power, 0.0), 1.0)
        share = period_s / 1.0
        self._settled_elevator += share * (elevator - self._settled_elevator)
        self._settled_throttle += share * (throttle - self._settled_throttle)
        return Demand(elevator, throttle, aileron, 0.0, CRUISE, 0.0)
