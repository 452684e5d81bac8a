"""Causes without a name in the contract: servo, moments, forces and air; each says what happens aboard."""

import numpy as np
from numpy.random import Generator

from .air import edged_updraft
from .flight import STEP_S
from .instruments import DEG
from .setup import Applied, Effect, Setup, moments, named_parameters, sign


def _amplitude(setup: Setup) -> float:
    return float(np.median([m.amplitude_rad for m in setup.plan.maneuvers]))


def _trimmed(setup: Setup) -> float:
    return float(np.mean([trimmed.delta for trimmed in setup.plan.trims]))


# Input.


def _notch(setup: Setup, size: float, rng: Generator) -> Applied:
    """The servo jumps across a worn place of its feedback potentiometer."""
    half = size * _amplitude(setup)
    at = _trimmed(setup) + sign(rng) * float(rng.uniform(0.35, 0.6)) * _amplitude(setup)
    return setup.steering(notch=half, notch_at=at), named_parameters(half_width_rad=half, at_rad=at)


def _upward(setup: Setup, size: float, rng: Generator) -> Applied:
    """The surface goes up more slowly than down, against its load."""
    lag = size / setup.plan.own_rad_s
    return setup.steering(upward_lag_s=lag), named_parameters(upward_lag_s=lag)


def _echo(setup: Setup, size: float, rng: Generator) -> Applied:
    """A repeater mixes an old command into the new one."""
    after = float(rng.uniform(1.5, 3.0)) / setup.plan.own_rad_s
    return setup.steering(echo=size, echo_s=after), named_parameters(share=size, after_s=after)


def _brownout(setup: Setup, size: float, rng: Generator) -> Applied:
    """The supply collapses at fast commands and the servo stands."""
    fastest = float(np.max(np.abs(np.diff(setup.plan.stick)))) / STEP_S
    stands = size / setup.plan.own_rad_s
    return setup.steering(brownout=0.45 * fastest, brownout_s=stands), named_parameters(stands_s=stands)


# Moment equation.


def _gear(setup: Setup, size: float, rng: Generator) -> Applied:
    """A door opens and closes below the nose within some tests."""
    plan, series = setup.plan, np.zeros(setup.plan.steps)
    for start in moments(setup, rng, int(rng.integers(2, 5))):
        begin = start + float(rng.uniform(-0.2, 1.0))
        moving = float(rng.uniform(0.8, 2.0)) * 3.0 / plan.own_rad_s
        series += edged_updraft(series.size, begin, moving, 1.0, 0.12 * moving)
    peak = sign(rng) * size * _moment_of_a_degree(setup)
    return setup.surrounded("moment", peak * series), named_parameters(cm=peak)


def _moment_of_a_degree(setup: Setup) -> float:
    body, model = setup.plan.shape, setup.plan.model
    pressure = 0.5 * body.density * body.speed_0**2
    return abs(model["M_alpha"]) * DEG * body.inertia / (pressure * body.area * body.chord)


def _buzz(setup: Setup, size: float, rng: Generator) -> Applied:
    """A cowl flap buzzes near the short period's frequency."""
    own = float(rng.uniform(0.7, 1.6)) * setup.plan.own_rad_s
    phase = own * setup.plan.time + float(rng.uniform(0.0, 6.28))
    swell = 1.0 + 0.4 * np.sin(0.11 * own * setup.plan.time)
    peak = size * _moment_of_a_degree(setup)
    return setup.surrounded("moment", peak * swell * np.sin(phase)), named_parameters(cm=peak, own_rad_s=own)


def _boom(setup: Setup, size: float, rng: Generator) -> Applied:
    """The tail boom bends and overshoots."""
    own = float(rng.uniform(2.0, 3.5)) * setup.plan.own_rad_s
    return setup.fault(bend=size, bend_rad_s=own), named_parameters(share=size, own_rad_s=own)


def _load(setup: Setup, size: float, rng: Generator) -> Applied:
    """A load swings below the centre of gravity."""
    own = float(rng.uniform(0.7, 1.4)) * setup.plan.own_rad_s
    length = 9.80665 / own**2
    weight = size * abs(setup.plan.model["M_alpha"]) * setup.plan.shape.inertia
    share = weight / (setup.plan.shape.mass * 9.80665 * setup.plan.shape.chord)
    return setup.fault(swing=share, swing_m=length), named_parameters(moment_share=share, length_m=length)


# Force equation.


def _spoilers(setup: Setup, size: float, rng: Generator) -> Applied:
    """Spoilers float above one load factor and close below another."""
    per_rad = abs(setup.plan.model["Z_alpha"]) * setup.plan.shape.speed_0 / 9.80665
    opens = 1.0 + per_rad * float(rng.uniform(0.7, 1.2)) * DEG
    closes = 1.0 - per_rad * float(rng.uniform(0.0, 0.7)) * DEG
    faulty = setup.fault(spoiler=size)
    return Setup(**{**vars(faulty), "spoilers": (opens, closes)}), named_parameters(
        lift_lost=size, opens_g=opens
    )


def _pulsation(setup: Setup, size: float, rng: Generator) -> Applied:
    """Lift pulsates with the wake of a fan."""
    own = float(rng.uniform(1.2, 2.5)) * setup.plan.own_rad_s
    wobble = np.cumsum(rng.normal(size=setup.plan.steps)) * np.sqrt(STEP_S) * 0.3
    weight = setup.plan.shape.mass * 9.80665
    pressure = 0.5 * setup.plan.shape.density * setup.plan.shape.speed_0**2
    peak = size * weight / (pressure * setup.plan.shape.area)
    series = peak * np.sin(own * setup.plan.time + wobble)
    return setup.surrounded("lift", series), named_parameters(cl=peak, own_rad_s=own)


def _springy(setup: Setup, size: float, rng: Generator) -> Applied:
    """The wing bends and its lift overshoots."""
    own = float(rng.uniform(1.4, 2.4)) * setup.plan.own_rad_s
    return setup.fault(flex=size, flex_rad_s=own), named_parameters(share=size, own_rad_s=own)


# Air.


def _street(setup: Setup, size: float, rng: Generator) -> Applied:
    """A regular train of rotors."""
    own = float(rng.uniform(0.5, 1.3)) * setup.plan.own_rad_s
    peak = size * setup.plan.shape.speed_0
    begin, end = np.sort(rng.uniform(0.0, setup.plan.time[-1], 2))
    begin, end = min(begin, 0.35 * setup.plan.time[-1]), max(end, 0.65 * setup.plan.time[-1])
    inside = 0.5 * (np.tanh(setup.plan.time - begin) - np.tanh(setup.plan.time - end))
    series = peak * inside * np.sin(own * setup.plan.time)
    return setup.surrounded("updraft", series), named_parameters(peak_m_s=peak, own_rad_s=own)


def _edges(setup: Setup, size: float, rng: Generator) -> Applied:
    """Sharply edged rising and sinking air."""
    peak, series = size * setup.plan.shape.speed_0, np.zeros(setup.plan.steps)
    for start in moments(setup, rng, int(rng.integers(3, 6))):
        length = float(rng.uniform(5.0, 14.0)) / setup.plan.own_rad_s
        series += edged_updraft(
            series.size, start + float(rng.uniform(-0.5, 1.0)), length, sign(rng) * peak, 0.08
        )
    return setup.surrounded("updraft", series), named_parameters(peak_m_s=peak)


def _devils(setup: Setup, size: float, rng: Generator) -> Applied:
    """Narrow vortices, up on one side and down on the other."""
    peak, series = size * setup.plan.shape.speed_0, np.zeros(setup.plan.steps)
    for start in moments(setup, rng, int(rng.integers(3, 6))):
        core = float(rng.uniform(0.5, 1.2)) / setup.plan.own_rad_s
        off = (setup.plan.time - start - float(rng.uniform(0.2, 2.0))) / core
        series += sign(rng) * peak * off * np.exp(0.5 * (1.0 - off**2))
    return setup.surrounded("updraft", series), named_parameters(peak_m_s=peak)


MOTION = {
    "worn_potentiometer": Effect("input", 0.1, 0.3, 0.35, _notch),
    "sluggish_upwards": Effect("input", 0.25, 0.9, 1.5, _upward),
    "command_echo": Effect("input", 0.1, 0.3, 0.45, _echo),
    "servo_brownout": Effect("input", 0.25, 0.7, 1.0, _brownout),
    "gear_cycle": Effect("moment_equation", 0.2, 1.0, 2.0, _gear),
    "cowl_buzz": Effect("moment_equation", 0.15, 0.7, 1.5, _buzz),
    "soft_tail_boom": Effect("moment_equation", 0.05, 0.2, 0.35, _boom),
    "swinging_load": Effect("moment_equation", 0.1, 0.4, 0.6, _load),
    "floating_spoilers": Effect("force_equation", 0.03, 0.12, 0.2, _spoilers),
    "lift_pulsation": Effect("force_equation", 0.02, 0.08, 0.15, _pulsation),
    "springy_wing": Effect("force_equation", 0.15, 0.5, 0.7, _springy),
    "rotor_street": Effect("air", 0.006, 0.025, 0.05, _street),
    "updraft_edges": Effect("air", 0.01, 0.04, 0.08, _edges),
    "dust_devils": Effect("air", 0.015, 0.05, 0.1, _devils),
}
