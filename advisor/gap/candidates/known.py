"""The catalogue, its nuisances, and the effects that the aircraft file already states for the simulator.

The effects of the aircraft file are part of every model. A diagnosis with an improved aircraft file therefore
finds the rest of the gap.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.delayed_fit import lateness_std
from advisor.flight.instruments.evidence import COMPUTED_WIDTH
from advisor.gap.effects import EFFECTS
from advisor.gap.kit.effect import Values, Variant, as_in_file
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import ENTRIES, INDEX, OUTPUTS, ROLL_YAW, SKEWS, SQUARES
from advisor.oem.instruments import COUPLING_PRIOR
from advisor.process.arrays import FloatArray

_FILTERS_S = 0.01
"""Prior standard deviation of the delay of an autopilot's filters, s. ArduPlane's default, a second-order
low-pass of 20 Hz, delays by 11 ms."""
REACH = 2.0
"""Largest delay of an autopilot's filters, in standard deviations of the prior."""
_OWN_FILTER_S = 0.045
"""Prior standard deviation of the lag of an angle of attack that an autopilot computes, s. Angles of attack
that an autopilot filters are 20 to 90 ms late."""

LOOP = Variant(
    "latency", "input", ("latency_s",), ((0.001,),), (5e-4,), ((-0.004, 0.005),), 0.0,
    entries=("latency_s",), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter until the command's motion is known: delay of the command between its stamps. Stamps
have a resolution, and a command takes effect within a loop of the autopilot."""

PROPELLER = Variant(
    "propeller", "moment_equation", ("M_thrust", "washed_share", "blown_share"), ((0.0, 0.0, 0.0),),
    (0.05, 0.05, 0.05), ((-100.0, 100.0), (-1.0, 2.0), (-10.0, 10.0)), 0.0,
    entries=("M_thrust", "washed_share", "blown_share"), prior_std=(5.0, 0.5, 3.0), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameters of every model with a measured air speed. The thrust's part of the trim does not grow
with V². An elevator in the propeller's wake meets a higher dynamic pressure, by thrust over disk area
(Glauert). Thrust is drag, which grows with V², plus the acceleration along the path. In a light single-engine
aircraft the wake adds about a fifth of the elevator's power."""

INERTIA = Variant(
    "inertia", "moment_equation", ("inertia_share", "inertia_product"), ((0.0, 0.0),), (0.02, 0.02),
    ((-0.5, 0.5), (-0.15, 0.15)), 0.0, entries=("inertia_share", "inertia_product"),
    prior_std=(COUPLING_PRIOR.std, 0.05), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameters of every model whose manoeuvres roll (``rolls``): the moments of p·r and of r² - p².
The factor of p·r is (I_zz - I_xx)/I_yy, relative to its prior mean. The other factor is I_xz/I_yy:
.05 where the principal axes tilt by 5 degrees (Etkin & Reid, Dynamics of Flight, 1996, ch. 4)."""

STATIC_PORT = 0.02
"""Prior: relative standard deviation of the air speed's error by the static port, which reads a pressure that
the wing changes."""
AIRSPEED = Variant(
    "true_air_speed", "accelerometer", ("scale",), ((0.0,),), (0.002,), ((-0.7, 3.0),), 0.0,
    entries=("speed_scale",), prior_std=(0.05,), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter of every model with a_z: the relative excess of the true over the read air speed. Data
sheets state 5 %. The read speed may be an indicated one, 3 to 5 % below the true one at 600 m."""

GYRO = Variant(
    "gyro_bias", "pitch_rate_sensor", ("bias_rad_s",), ((0.0,),), (5e-4,), ((-0.015, 0.015),), 0.0,
    entries=("q_bias",), prior_std=(0.003,), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter of every model: the bias of the pitch rate. The zero rate of a MEMS gyro moves by .01 to
.05 deg/s per kelvin after its calibration: .17 deg/s in flight."""

OWN_ALPHA = Variant(
    "own_alpha", "alpha_sensor", ("lag_s", "scale"), ((0.0, 0.0),), (1e-3, 0.002),
    ((0.0, 2.0 * _OWN_FILTER_S), (-2.0 * COMPUTED_WIDTH, 2.0 * COMPUTED_WIDTH)), 0.0,
    entries=("alpha_lag_s", "alpha_scale"), prior_std=(_OWN_FILTER_S, COMPUTED_WIDTH), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameters of every model with an angle of attack that an autopilot computes: its filter, and its
scale."""


def _late_imu(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Delay pitch rate and acceleration by one common time."""
    p[:, [INDEX[SKEWS[OUTPUTS.index(channel)]] for channel in ("q", "a_z")]] += values[0]


IMU = Variant(
    "imu_late", "timing", ("late_s",), ((0.0,),), (1e-3,), ((0.0, REACH * _FILTERS_S),), 0.0,
    apply_with=_late_imu, prior_std=(_FILTERS_S,), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter of every model without an autopilot's angle of attack: the delay that unstated filters
of gyro and accelerometer cause. Neither a vane nor the attitude passes the filters of gyro and
accelerometer. With filters of 15 to 30 Hz the first answer was wrong in 15 of 27 flights without this
parameter, and in 3 with it."""


def rolls(flights: PreparedManeuvers) -> bool:
    """Return whether a standard error of the moments of inertia changes the likelihood of the pitch rate.

    The change of the pitch rate, without a part linear in time, is compared with the gyro's white noise.
    """
    power = np.zeros(2)
    for flight in flights.flights:
        turned = np.cumsum(flight.slow[[ROLL_YAW, SQUARES]], axis=1).T * flight.h
        course = np.vander(np.arange(len(turned)), 2)
        turned -= course @ np.linalg.lstsq(course, turned, rcond=None)[0]
        power += len(flight.outputs["q"].t) * np.mean(turned**2, axis=0)
    white = float(flights.white[flights.channels.index("q")])
    return bool(np.any(power * np.square(INERTIA.prior_std) > white**2))


def latency(flights: PreparedManeuvers) -> Variant:
    """Return the nuisance parameter for the command's delay behind its stamps.

    An autopilot renews the command at one rate and a stream samples it at another, with a phase that differs
    from flight to flight. The prior is that of the estimate (``lateness``). The prior's standard deviation is
    also the largest delay, because all 28 flights stay within it.
    """
    std = lateness_std([flight.t_u for flight in flights.flights])
    return Variant(
        "latency", "input", ("latency_s",), ((0.001,),), (5e-4,), ((-std, std),), 0.0,
        entries=LOOP.entries, prior_std=(std,), is_nuisance=True,
    )  # fmt: skip


def filters(flights: PreparedManeuvers) -> Variant:
    """Return the delays of an autopilot's own channels relative to its pitch rate, as nuisance parameters.

    The autopilot's own angle of attack is as late as the estimate assumes (``lateness``): held over an
    interval, and up to 90 ms late.
    """
    std = dict.fromkeys(("a_z", "theta"), _FILTERS_S)
    if "alpha" in flights.channels:
        std["alpha"] = lateness_std([flight.outputs["alpha"].t for flight in flights.flights])
    channels = [c for c in flights.channels if c in std]
    return Variant(
        "filters", "timing", tuple(f"{c}_late_s" for c in channels), ((0.0,) * len(channels),),
        (1e-3,) * len(channels), tuple((-REACH * std[c], REACH * std[c]) for c in channels), 0.0,
        entries=tuple(SKEWS[OUTPUTS.index(c)] for c in channels),
        prior_std=tuple(std[c] for c in channels), is_nuisance=True,
    )  # fmt: skip


_IN_FILE = 1e-5
"""Relative precision of a number in the improved file, which has six digits."""
Effects = Mapping[str, Mapping[str, float]]
"""Parameters of each effect, by the effect's name, in the units of the aircraft file."""
AIR = frozenset(name for name, effect in EFFECTS.items() if effect.block == "air")
"""Effects of moving air, which no fit can carry from one flight to another."""


def base_entries(aircraft: Aircraft) -> FloatArray:
    """Return the simulator's inputs that the file states for servo and instruments, shape (entries,)."""
    base = np.zeros(len(ENTRIES))
    base[INDEX["lag_s"]] = aircraft.elevator.lag_s or 0.0
    base[INDEX["delay_s"]] = aircraft.elevator.delay_s or 0.0
    base[INDEX["vane_arm_m"]] = aircraft.alpha.vane_arm_m or 0.0
    base[INDEX["imu_arm_m"]] = aircraft.accelerometer.arm_m or 0.0
    base[INDEX["inertia_share"]] = COUPLING_PRIOR.mean
    return base


def with_known(
    base: FloatArray, effects: Effects, flights: PreparedManeuvers, variants: Sequence[Variant]
) -> FloatArray:
    """Return the simulator's inputs of each manoeuvre, shape (manoeuvres, entries), with the file's effects
    added."""
    numbers = np.tile(base, (len(flights), 1))
    for variant, values in _as_stated(lasting(effects), variants):
        variant.apply(numbers, values, flights)
    return numbers


def changes_in(effects: Effects, variants: Sequence[Variant]) -> tuple[tuple[Variant, Values], ...]:
    """Return the aircraft file's changes in flight, of mass, balance or ice, with their sizes."""
    return tuple(_as_stated({e: effects[e] for e in effects if EFFECTS[e].of_one_flight}, variants))


def _as_stated(effects: Effects, variants: Sequence[Variant]) -> Iterator[tuple[Variant, Values]]:
    """Yield the variant of each effect that describes most of the file's entry, and its values."""
    for effect, parameters in effects.items():
        described = [w for v in variants if v.effect == effect for w in (v, *v.likewise)]
        meant = [w for w in described if _says(w, parameters)]
        for variant in sorted(meant, key=lambda v: (-len(v.fixed), -len(v.names)))[:1]:
            yield as_in_file(variant, EFFECTS[effect].curve, parameters), _values(variant, parameters)


def beyond_known(effects: Effects, variants: Sequence[Variant]) -> list[Variant]:
    """Return the candidates for effects beyond those that the aircraft file states. An effect with one
    parameter may differ from the file's value; the shape of any other effect is fixed."""
    left = []
    for variant in variants:
        stated = {} if EFFECTS[variant.effect].of_one_flight else effects.get(variant.effect, {})
        if stated.keys().isdisjoint(variant.names):
            left.append(variant)
        elif len(variant.names) == 1 and not variant.inverted and _is_meant(variant, stated, variants):
            left.append(_beyond(variant, stated[variant.names[0]]))
    return left


def beyond_servo(aircraft: Aircraft, variants: Sequence[Variant]) -> list[Variant]:
    """Return the candidates with a servo's lag or delay counted from the value that the aircraft file states.

    A servo may be quicker than the file states, and a stated delay may not exist.
    """
    beyond = []
    for variant in variants:
        stated = None if variant.fixed else stated_in(aircraft, variant.effect)
        beyond.append(_beyond(variant, stated) if stated else variant)
    return beyond


def less_of_the_servo(
    aircraft: Aircraft, effects: Effects
) -> tuple[Aircraft, dict[str, Mapping[str, float]]]:
    """Return the aircraft with negative servo effects subtracted from its lag or delay, and the other
    effects.

    No simulator flies a negative lag or delay, so such a value is subtracted from the file's.
    """
    rest = dict(effects)
    changed: dict[str, Any] = {}
    for effect, values in effects.items():
        where, stated = EFFECTS[effect].stated, stated_in(aircraft, effect)
        less = 0.0 if where is None or where[0] != "elevator" else values.get(where[1], 0.0)
        if where is not None and stated and less < 0.0:
            changed[where[1]] = max(stated + less, 0.0)
            del rest[effect]
    return replace(aircraft, elevator=replace(aircraft.elevator, **changed)), rest


def stated_in(aircraft: Aircraft, effect: str) -> float | None:
    """Return the value that the aircraft file states for an effect; None if the file states no value."""
    where = EFFECTS[effect].stated
    stated: float | None = None if where is None else getattr(getattr(aircraft, where[0]), where[1])
    return stated


def lasting(effects: Effects) -> Effects:
    """Return the file's effects without those that belong to one flight alone."""
    return {name: values for name, values in effects.items() if not EFFECTS[name].of_one_flight}


def left_aside(effects: Effects, *shown: Collection[str]) -> tuple[str, ...]:
    """Return the names of the file's effects that a flight does not show."""
    return tuple(effect for effect in effects if not any(effect in some for some in shown))


def together(stated: Effects, added: Effects) -> dict[str, dict[str, float]]:
    """Return the aircraft file's effects combined with the newly found effects.

    The first parameter of a found effect adds to the file's value. Other parameters, such as the damping of a
    servo, replace the file's value.
    """
    both = {effect: dict(values) for effect, values in stated.items()}
    for effect, values in added.items():
        before = {} if EFFECTS[effect].of_one_flight else both.get(effect, {})
        both[effect] = before | dict(values)
        for size in [name for name in values if name not in PROPELLER.names][:1]:
            both[effect][size] += before.get(size, 0.0)
    return both


def _beyond(variant: Variant, stated: float) -> Variant:
    """Return the candidate counted from the file's value; the range includes the removal of that value."""
    (lowest, highest), starts = variant.bounds[0], variant.starts
    if stated > 0.0 and lowest >= 0.0:
        lowest, starts = -stated, (*starts, (-0.5 * stated,))
    elif stated < 0.0 and highest <= 0.0:
        highest, starts = -stated, (*starts, (-0.5 * stated,))
    beyond = replace(variant, starts=starts, bounds=((lowest, highest),))
    if not variant.sets:
        return beyond

    def apply(p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
        variant.apply(p, [stated + values[0]], flights)

    return replace(beyond, apply_with=apply)


def _says(variant: Variant, parameters: Mapping[str, float]) -> bool:
    fixed = variant.fixed.items()
    same = all(
        np.isclose(parameters.get(name, np.nan), value, rtol=_IN_FILE, atol=0.0) for name, value in fixed
    )
    needed = list(variant.in_file)[:1] or variant.names
    return same and all(name in parameters for name in needed)


def _is_meant(variant: Variant, parameters: Mapping[str, float], variants: Sequence[Variant]) -> bool:
    """Return whether the variant describes the file's entry best among all variants."""
    same = [v for v in variants if v.effect == variant.effect and _says(v, parameters)]
    return _says(variant, parameters) and all(len(v.fixed) <= len(variant.fixed) for v in same)


def _values(variant: Variant, parameters: Mapping[str, float]) -> list[float]:
    """Return variant parameters from the aircraft file's entry: the inverse of ``causes.parameters_of``."""
    spelled = {name: (key, factor) for key, (name, factor) in variant.in_file.items()}
    if spelled:
        keys = [spelled[name] for name in variant.names]
        return [factor * parameters.get(key, 0.0) for key, factor in keys]
    values = [parameters[name] for name in variant.names]
    return [1.0 / max(values[0], 1e-9), *values[1:]] if variant.inverted else values


def variants_for(flights: PreparedManeuvers) -> list[Variant]:
    """Return all variants whose channels were recorded and whose input varied in the flight."""
    possible = [effect for effect in EFFECTS.values() if effect.channel in ("", *flights.channels)]
    return [v for effect in possible for v in effect.variants(flights) if v.needs <= flights.has]
