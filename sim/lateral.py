"""Roll and yaw of the bundled aircraft, and the pilot who flies them: ``python -m sim fly --plan lateral``.

The equations are those of Stevens & Lewis, *Aircraft Control and Simulation*, ch. 2. Forces and moments are
linear, and the kinematics of gravity and attitude are exact:

    β̇ = (Y/m)/V + sin α·p − cos α·r + (g/V)·cos θ·sin φ
    ṗ = L,    ṙ = N,    φ̇ = p + tan θ·r·cos φ

Angle of attack, pitch and speed stay at their trim. A positive aileron rolls to the left, a positive rudder
yaws to the left; the pilot's demands are positive to the right.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import hangar
from .airframe import GRAVITY_M_S2
from .autopilot import CRUISE, MANUAL, Demand, Planned
from .effects.side import SideKit, side_kit
from .flight import Flight
from .linear import ShortPeriod
from .linear_aircraft import LinearAircraft
from .maneuvers import stepped
from .motion import Controls, Motion
from .scenario import Maneuver, Scenario
from .sensors import Reading
from .servo import FirstOrderServo, Servo

UAV: Mapping[str, float] = {
    "Y_beta": -0.6, "Y_p": 0.0, "Y_r": 0.01, "Y_delta_a": 0.0, "Y_delta_r": 0.15, "L_beta": -14.0,
    "L_p": -10.0, "L_r": 2.6, "L_delta_a": -60.0, "L_delta_r": 1.5, "N_beta": 11.0, "N_p": -0.9, "N_r": -1.5,
    "N_delta_a": 1.8, "N_delta_r": -10.0,
}  # fmt: skip
"""Lateral derivatives of the bundled aircraft at 25 m/s, rad and s; Dutch roll 3.7 rad/s, roll 0.1 s."""
FULL_RAD = math.radians(25.0)
"""Aileron and rudder deflection at full demand, rad."""
NOISE = {"p": 0.004, "r": 0.003, "phi": 0.002, "a_y": 0.05}
"""Standard deviation of the noise in each lateral channel, SI."""
_SWING_S = 3.1
"""Period of the throttle's swing, s."""
_HOLD = (0.12, 0.02)
"""Demand of the wing leveller per rad of bank and per rad/s of roll rate."""


class LateralAircraft(LinearAircraft):
    """An engine (see :class:`sim.motion.Engine`) that flies roll and yaw about a steady trim.

    Parameters
    ----------
    model
        Short-period parameters, which give the level trim.
    airspeed_m_s, height_m
        Speed in m/s and height in m, both constant.
    derivatives
        Lateral derivatives at this speed, by name.
    kit
        Servos, propeller and air of the effects; None for no effects.
    """

    def __init__(
        self,
        model: ShortPeriod,
        airspeed_m_s: float,
        height_m: float,
        derivatives: Mapping[str, float],
        kit: SideKit | None = None,
    ) -> None:
        super().__init__(model, airspeed_m_s, height_m)
        self._d = dict(derivatives)
        self._kit = kit or SideKit(0)
        self._servos = [Servo(tuple(self._kit.mechanisms[name])) for name in ("aileron", "rudder")]
        self._gust = 0.0
        self._side = np.zeros(4)
        self._surfaces = np.zeros(2)
        self._steady = super().motion()

    def step(self, controls: Controls, dt: float) -> Motion:
        """Fly for ``dt`` seconds and return the resulting motion."""
        wanted = [-FULL_RAD * controls.aileron, -FULL_RAD * controls.rudder]
        before = self._surfaces
        pairs = zip(self._servos, wanted, strict=True)
        self._surfaces = np.array([servo.step(u, dt) for servo, u in pairs])
        self._surfaces[0] += self._kit.torque_rad * (controls.throttle - self.trim.throttle)
        if self._kit.side_gusts is not None:
            speed = self._steady.airspeed
            self._gust = self._kit.side_gusts.step(speed, dt)[0] / speed
        middle = 0.5 * (before + self._surfaces)
        k1 = self._side_rates(self._side, before)
        k2 = self._side_rates(self._side + 0.5 * dt * k1, middle)
        k3 = self._side_rates(self._side + 0.5 * dt * k2, middle)
        k4 = self._side_rates(self._side + dt * k3, self._surfaces)
        self._side = self._side + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        return self.motion()

    def motion(self) -> Motion:
        """Return the motion now."""
        _, p, r, phi = self._side.tolist()
        steady = self._steady
        down = steady.a_z + GRAVITY_M_S2 * math.cos(steady.theta) * (1.0 - math.cos(phi))
        side = steady.airspeed * self._per_speed("Y", self._side, self._surfaces)
        return steady._replace(phi=phi, p=p, r=r, a_y=side, a_z=down)

    def _per_speed(self, letter: str, x: NDArray[np.float64], u: NDArray[np.float64]) -> float:
        """Return the side force over mass and speed (Y), or a moment over its inertia (L, N).

        The sideways motion of the air adds an angle to the sideslip."""
        met = (x[0] + self._gust, *x[1:3], *u)
        factors = zip(("beta", "p", "r", "delta_a", "delta_r"), met, strict=True)
        return float(sum(self._d[f"{letter}_{name}"] * value for name, value in factors))

    def _side_rates(self, x: NDArray[np.float64], u: NDArray[np.float64]) -> NDArray[np.float64]:
        _, p, r, phi = x
        alpha, theta = self._steady.alpha, self._steady.theta
        turn = math.sin(alpha) * p - math.cos(alpha) * r
        weight = GRAVITY_M_S2 / self._steady.airspeed * math.cos(theta) * math.sin(phi)
        return np.array(
            [
                self._per_speed("Y", x, u) + turn + weight,
                self._per_speed("L", x, u),
                self._per_speed("N", x, u),
                p + math.tan(theta) * r * math.cos(phi),
            ]
        )


@dataclass(frozen=True)
class SideInput:
    """One input in the lateral plan."""

    control: str
    """``aileron`` or ``rudder``."""
    steps: tuple[tuple[float, float], ...]
    """Duration in units and share of the amplitude, as in :data:`sim.maneuvers.STEPS`."""
    amplitude: float
    """Demand of the input, 0..1."""
    unit_s: float


_DOUBLET = ((1.0, 1.0), (1.0, -1.0))
_BANK_TO_BANK = ((1.0, 1.0), (2.0, -1.0), (1.0, 1.0))
PLAN = (
    SideInput("aileron", _DOUBLET, 0.25, 0.5),
    SideInput("rudder", _DOUBLET, 0.25, 0.85),
    SideInput("aileron", _BANK_TO_BANK, 0.15, 0.9),
    SideInput("rudder", tuple((n, -share) for n, share in _DOUBLET), 0.25, 0.85),
    SideInput("aileron", tuple((n, -share) for n, share in _DOUBLET), 0.25, 0.5),
)
"""Inputs of ``--plan lateral``. Rudder steps last half a Dutch roll, and aileron steps five roll time
constants."""


class LateralPilot:
    """Pilot who levels the wings between the inputs. During an input the pilot moves only the control of the
    plan.

    Parameters
    ----------
    scenario
        Scenario with the durations before and after each input.
    trim
        Trimmed controls of level flight.
    swing
        Amplitude of the throttle's slow oscillation, 0..1.
    slower
        Factor on the steps' duration, for an aircraft with a slower Dutch roll.
    """

    def __init__(self, scenario: Scenario, trim: Controls, swing: float = 0.0, slower: float = 1.0) -> None:
        self._trim, self._swing = trim, swing
        self._inputs: list[tuple[SideInput, Planned]] = []
        now = scenario.lead_in_s
        for one in PLAN:
            stick = stepped(one.steps, one.amplitude, slower * one.unit_s)
            start = now + scenario.settling_s
            end = start + stick.duration_s + 2.0 * scenario.free_s
            self._inputs.append((one, Planned(Maneuver(input="none"), stick, now, start, end)))
            now = end + scenario.gap_s
        self.end_s = now

    def current(self, time_s: float) -> Planned | None:
        """Return the input that is flown at ``time_s``, between the mode changes to MANUAL and back."""
        return next((p for _, p in self._inputs if p.manual_from_s <= time_s < p.end_s), None)

    def mode(self, time_s: float) -> int:
        """Return the flight mode at ``time_s``."""
        return CRUISE if self.current(time_s) is None else MANUAL

    def demand(self, time_s: float, motion: Motion, period_s: float) -> Demand:
        """Return the controls at ``time_s``, computed from ``motion`` one tick earlier."""
        moved = {"aileron": 0.0, "rudder": 0.0}
        planned = self.current(time_s)
        if planned is None:
            moved["aileron"] = -_HOLD[0] * motion.phi - _HOLD[1] * motion.p
        else:
            control = next(one.control for one, p in self._inputs if p is planned)
            moved[control] = planned.input.pull(time_s - planned.start_s)
        return Demand(
            self._trim.elevator,
            self._trim.throttle + self._swing * math.sin(2.0 * math.pi * time_s / _SWING_S),
            moved["aileron"],
            moved["rudder"],
            self.mode(time_s),
            0.0,
        )


class LateralNoise:
    """White noise of the gyros, the attitude and the lateral accelerometer."""

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng([seed, 61])

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Add one draw to each lateral channel."""
        for (name, sigma), drawn in zip(NOISE.items(), self._generator.standard_normal(4), strict=True):
            setattr(reading, name, getattr(reading, name) + sigma * float(drawn))


def lateral_flight(scenario: Scenario, noisy: bool = True) -> Flight:
    """Return the lateral plan flown by the bundled aircraft under a scenario's servo, rates and times."""
    known = hangar.build(scenario)
    speed = known.motion().airspeed
    kit = side_kit(scenario.seed, scenario.effects)
    if scenario.servo.lag_s > 0.0:
        for stages in kit.mechanisms.values():
            stages.append(FirstOrderServo(scenario.servo.lag_s))
    engine = LateralAircraft(known.truth, speed, scenario.height_m, UAV, kit)
    return flown_laterally(scenario, engine, kit, noisy)


def flown_laterally(
    scenario: Scenario, engine: hangar.Aircraft, kit: SideKit, noisy: bool = True, slower: float = 1.0
) -> Flight:
    """Return the lateral plan, flown by an engine that accepts aileron and rudder."""
    pilot = LateralPilot(scenario, engine.trim, kit.swing, slower)
    if noisy:
        kit.fittings.sensors.append(LateralNoise(scenario.seed))
    return Flight(scenario, kit.fittings, engine, pilot, pilot.end_s + scenario.closing_s)
