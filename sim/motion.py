"""What every aircraft here answers with: its motion, whichever engine computed it."""

from typing import NamedTuple, Protocol


class Motion(NamedTuple):
    """The true motion at one instant, SI units, and the air the aircraft flies through."""

    airspeed: float
    """m/s, of the motion through the air mass, without gusts."""
    alpha: float
    q: float
    theta: float
    height: float
    """m above ground"""
    phi: float
    p: float
    climb: float
    """m/s, up positive."""
    airspeed_dot: float
    alpha_dot: float
    q_dot: float
    a_x: float
    """m/s², specific force along body x, at the centre of gravity."""
    a_z: float
    """m/s², specific force along body z (down), at the centre of gravity."""
    elevator: float
    """rad, the surface itself, trailing edge down positive."""
    throttle: float
    gust_up: float
    """m/s, what gusts add: α of the air is α + gust_up / V."""
    gust_head: float
    """m/s, added to the airspeed."""

    @property
    def air_alpha(self) -> float:
        """Angle of attack that wing and vane meet, rad."""
        return self.alpha + self.gust_up / self.airspeed

    @property
    def pitot_airspeed(self) -> float:
        """Airspeed that the pitot tube meets, m/s."""
        return self.airspeed + self.gust_head


class Controls(NamedTuple):
    """What moves the aircraft at one instant."""

    elevator: float
    """rad, the surface."""
    throttle: float
    """0..1"""
    aileron: float
    """−1..1"""
    gust_up: float = 0.0
    gust_head: float = 0.0
    extra_cl: float = 0.0
    """Lift coefficient added by an effect from outside the equations of motion."""
    extra_cm: float = 0.0
    """Pitching moment coefficient added likewise."""


class Engine(Protocol):
    """Flight dynamics: a trimmed aircraft that can be stepped."""

    @property
    def trim(self) -> Controls:
        """Controls that keep the aircraft in level flight."""
        ...

    def motion(self) -> Motion:
        """Return the motion now."""
        ...

    def step(self, controls: Controls, dt: float) -> Motion:
        """Fly for ``dt`` seconds, controls moving linearly to ``controls``; return the motion then."""
        ...
