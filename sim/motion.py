"""Interface of every aircraft in this package to its motion, for any engine."""

from typing import NamedTuple, Protocol

HOME_HEIGHT_M = 600.0
"""Height of the ground above sea level, m."""


class Motion(NamedTuple):
    """True motion at one instant, SI units, and the air around the aircraft."""

    airspeed: float
    """Speed through the air mass without gusts, m/s."""
    alpha: float
    q: float
    theta: float
    height: float
    """Height above ground, m."""
    phi: float
    p: float
    climb: float
    """Climb rate, m/s, up positive."""
    airspeed_dot: float
    alpha_dot: float
    q_dot: float
    a_x: float
    """Specific force along body x at the centre of gravity, m/s²."""
    a_z: float
    """Specific force along body z (down) at the centre of gravity, m/s²."""
    elevator: float
    """Deflection of the surface, not of the command, rad, trailing edge down positive."""
    throttle: float
    gust_up: float
    """Vertical gust, m/s; the angle of attack of the air is α + gust_up / V."""
    gust_head: float
    """Head-on gust, m/s, added to the airspeed."""
    r: float | None = None
    """Yaw rate, rad/s. Yaw rate, rad/s; None for the yaw rate of a coordinated turn."""
    a_y: float = 0.0
    """Specific force along body y at the centre of gravity, m/s²."""

    @property
    def air_alpha(self) -> float:
        """Angle of attack of the air at wing and vane, rad."""
        return self.alpha + self.gust_up / self.airspeed

    @property
    def pitot_airspeed(self) -> float:
        """Airspeed at the pitot tube, including gusts, m/s."""
        return self.airspeed + self.gust_head


class Controls(NamedTuple):
    """Positions of the controls at one instant."""

    elevator: float
    """Deflection of the surface, rad."""
    throttle: float
    """Throttle, 0..1."""
    aileron: float
    """Aileron, −1..1."""
    gust_up: float = 0.0
    gust_head: float = 0.0
    extra_cl: float = 0.0
    """Lift coefficient added by an effect from outside the equations of motion."""
    extra_cm: float = 0.0
    """Pitching moment coefficient added by an effect from outside the equations of motion."""
    rudder: float = 0.0
    """Rudder, −1..1."""


class Engine(Protocol):
    """Flight dynamics: a trimmed aircraft that can be stepped."""

    @property
    def trim(self) -> Controls:
        """Controls that keep the aircraft in level flight."""
        ...

    def motion(self) -> Motion:
        """Return the present motion."""
        ...

    def step(self, controls: Controls, dt: float) -> Motion:
        """Fly for ``dt`` seconds with linear control changes to ``controls``, and return the motion."""
        ...
