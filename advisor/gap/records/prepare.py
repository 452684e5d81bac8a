"""Preparation of the manoeuvres for the diagnosis: slow inputs on the time grid, and instrument
properties."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import Reference
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.records.airspeed import (
    STEP_S,
    airspeed_on,
    along_the_path,
    measures_speed,
    smooth,
    speed_error_factors,
)
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.records.smoothness import is_filtered, is_smoothed, white_part
from advisor.gap.records.unmeasured_alpha import is_estimate
from advisor.gap.records.unmeasured_speed import speed_without_instrument, speeds_about
from advisor.gap.records.usable import edges_of, held_from, outputs_of, recorded, usable_of
from advisor.gap.simulator.layout import OUTPUTS, SLOW, SPEED, THETA_FROM, THRUST
from advisor.oem.prepare import sideslip_turn, signal_of
from advisor.oem.problem import ASSUMED_M_S
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray

_CHORD_OF_1_KG_M = 0.15
"""Prior: chord of an aircraft of 1 kg, m. Chords grow with the cube root of the mass. A glider of 3.1 kg has
0.17 m, a UAV of 10 kg 0.3 m, and a jet of 50 t 4.2 m."""


def prepare(
    maneuvers: Sequence[Maneuver], aircraft: Aircraft, true_over_read: float = 1.0
) -> PreparedManeuvers:
    """Prepare the manoeuvres for the diagnosis, without those that ``usable_of`` rejects.

    ``true_over_read`` is the ratio of the true air speed to the air speed that is read, 1 if unknown.
    """
    usable = usable_of(maneuvers)
    measured = bool(usable) and all(map(measures_speed, usable))
    if measured:
        reference, flights, moves = _at_measured_speed(usable, aircraft, true_over_read)
    else:
        reference, flights, moves = _at_speed_of_motion(usable, aircraft)
    common = set.intersection(*(set(f.outputs) for f in flights)) if flights else set()
    channels = tuple(name for name in OUTPUTS if name in common)
    flights = tuple(_with_rows(f, channels) for f in flights)
    has = frozenset(
        name
        for name in ("airspeed", "a_x", "bank", "throttle", "height", "climb_rate")
        if usable and all(name in m.channels and len(m.channels[name]) > 1 for m in usable)
    )
    smoothed, derived = _kind_of_alpha(usable, flights, "alpha" in channels)
    whole = [[f.outputs[c].y for f in flights] for c in channels]
    white = np.array([white_part(series) for series in whole])
    peaks = np.array([np.median([_departure(y) for y in series]) for series in whole])
    return PreparedManeuvers(
        flights, channels, measured, reference, moves, derived, derived or smoothed, has, white, peaks,
        _chord(aircraft.reference),
    )  # fmt: skip


def _chord(reference: Reference) -> float | None:
    """Return the chord from the aircraft file, or the typical chord for the stated mass."""
    if reference.chord_m is not None or reference.mass_kg is None:
        return reference.chord_m
    return float(_CHORD_OF_1_KG_M * np.cbrt(reference.mass_kg))


def _at_measured_speed(
    usable: Sequence[Maneuver], aircraft: Aircraft, true_over_read: float
) -> tuple[float, tuple[PreparedManeuver, ...], float]:
    """Return reference speed (m/s), flights, largest relative speed change, from measured air speed."""
    means = [np.mean(m.channels["airspeed"].y) for m in usable]
    reference = aircraft.reference_airspeed_m_s or float(np.mean(means))
    flights = _about_their_mean(_ready(m, reference, None, true_over_read) for m in usable)
    return reference, _with_speed_errors(flights, usable), _largest_departure(flights)


def _at_speed_of_motion(
    usable: Sequence[Maneuver], aircraft: Aircraft
) -> tuple[float, tuple[PreparedManeuver, ...], float]:
    """Return reference speed (m/s), flights, largest relative speed change, without a speed sensor."""
    reference = aircraft.stated_airspeed_m_s or ASSUMED_M_S
    shown = speeds_about(usable, reference)
    flights = _about_their_mean(
        _ready(m, reference, float(level), 1.0) for m, level in zip(usable, shown.before_m_s, strict=True)
    )
    factors = (np.array([[std]]) for std in shown.std_m_s)
    flights = tuple(replace(f, speed_error_factor=e) for f, e in zip(flights, factors, strict=True))
    return reference, flights, shown.moves


def _kind_of_alpha(
    usable: Sequence[Maneuver], flights: Sequence[PreparedManeuver], in_all: bool
) -> tuple[bool, bool]:
    """Return whether α was smoothed before it was stored, and whether it is an estimate."""

    def quiet(channel: str) -> list[FloatArray]:
        return [y for f in flights for y in f.quiet_stretches(channel)]

    smoothed = in_all and is_smoothed(quiet("alpha"))
    # Where the whole record was filtered on the ground, a smooth α does not indicate an estimator.
    of_estimator = smoothed and not is_filtered(quiet("q"))
    return smoothed, any(is_estimate(m, of_estimator) for m in usable)


def _departure(y: FloatArray) -> float:
    """Return the largest deviation of a series from its starting value."""
    return float(np.max(np.abs(y - np.median(y[: max(5, len(y) // 50)]))))


def _about_their_mean(flights: Iterable[PreparedManeuver]) -> tuple[PreparedManeuver, ...]:
    """Return the manoeuvres with thrust minus drag relative to its mean over all manoeuvres."""
    prepared = tuple(flights)
    if prepared:
        mean = float(np.mean(np.concatenate([f.slow[THRUST] for f in prepared])))
        for flight in prepared:
            flight.slow[THRUST] -= mean
    return prepared


def _with_speed_errors(
    flights: Sequence[PreparedManeuver], maneuvers: Sequence[Maneuver]
) -> tuple[PreparedManeuver, ...]:
    """Return the manoeuvres with the uncertainty of their air speeds."""
    stamps, residuals = [], []
    for flight, maneuver in zip(flights, maneuvers, strict=True):
        read = maneuver.channels["airspeed"].cut(flight.started_s, flight.started_s + flight.duration_s)
        t = read.t - flight.started_s
        grid = (np.arange(flight.n) + 0.5) * flight.h
        stamps.append(t)
        residuals.append(read.y - np.interp(t, grid, flight.slow[SPEED]))
    factors = speed_error_factors(stamps, residuals, [flight.duration_s for flight in flights])
    return tuple(replace(f, speed_error_factor=factor) for f, factor in zip(flights, factors, strict=True))


def _largest_departure(flights: Sequence[PreparedManeuver]) -> float:
    """Return the largest relative deviation of the air speed from its mean over all manoeuvres, or 0."""
    if not flights:
        return 0.0
    speeds = np.concatenate([flight.slow[SPEED] for flight in flights])
    return float(np.max(np.abs(speeds / np.mean(speeds) - 1.0)))


def _ready(m: Maneuver, reference: float, level: float | None, true_over_read: float) -> PreparedManeuver:
    """Return a manoeuvre on the time grid; ``level``: air speed before the first step if unlogged, m/s."""
    start, end = recorded(m)
    n = int(np.ceil((end - start) / STEP_S)) + 1
    grid: FloatArray = (np.arange(n, dtype=np.float64) + 0.5) * STEP_S
    first = m.span.start_s - start

    def on_grid(name: str, otherwise: float) -> FloatArray:
        channel = m.channels.get(name)
        if channel is None or len(channel) < 2:
            return np.full(n, otherwise)
        return np.asarray(np.interp(grid, channel.t - start, channel.y))

    speed = (
        airspeed_on(grid, m, start, true_over_read)
        if level is None
        else speed_without_instrument(grid, m, start, level)
    )
    theta_at = on_grid("theta", 0.0)
    a_x = smooth(on_grid("a_x", GRAVITY_M_S2 * float(np.sin(theta_at[0]))), 0.05)
    bank = smooth(on_grid("bank", 0.0), 0.1)
    throttle = on_grid("throttle", 0.0)
    # Without a yaw rate in the log, a bank is taken as a coordinated turn.
    yaw_rate = smooth(on_grid("r", 0.0), 0.1) if "r" in m.channels else GRAVITY_M_S2 / speed * np.sin(bank)
    slipping = sideslip_turn(m.channels, signal_of(a)) if (a := m.channels.get("alpha")) else None
    slow = np.vstack(SLOW._replace(speed=speed, a_x=a_x, bank=bank, height=on_grid("height", 1e3),
                                   thrust=along_the_path(grid, m, start) / GRAVITY_M_S2,
                                   turn=yaw_rate * np.sin(bank),
                                   roll_yaw=on_grid("p", 0.0) * on_grid("r", 0.0),
                                   squares=on_grid("r", 0.0) ** 2 - on_grid("p", 0.0) ** 2,
                                   slip=np.zeros(n) if slipping is None else slipping.at(grid + start),
                                   throttle=throttle - float(np.mean(throttle[:20]))))  # fmt: skip
    outputs = outputs_of(m)
    t_u, u = m.channels["elevator"].t - start, m.channels["elevator"].y
    before = m.before.get("elevator") or m.channels["elevator"].cut(-np.inf, -np.inf)
    lead = (t_u >= 0.0) & (t_u < max(first - 0.02, 0.1))
    u_trim = float(np.median(u[lead])) if np.any(lead) else float(u[0])

    angle = _trimmed_alpha(m, outputs, start, first)
    trim = np.array([angle, angle, reference, 1.0])
    if "theta" in outputs:
        trim[THETA_FROM] = float(np.mean(outputs["theta"].y[:3]))
    elif "theta" in m.channels:
        trim[THETA_FROM] = float(theta_at[0])
    return PreparedManeuver(
        m.number, start, first, m.span.last_step_s - start, STEP_S, n, t_u, held_from(t_u), u,
        Signal(before.t - start, before.y), u_trim,
        slow, trim, outputs, edges_of(t_u, u),
    )  # fmt: skip


def _trimmed_alpha(m: Maneuver, outputs: Mapping[str, Signal], start: float, first: float) -> float:
    """Return the angle of attack before the first step, rad: measured, or from the motion; else 0."""
    if "alpha" in outputs:
        return _at_start(outputs["alpha"], first)
    if not (alpha := m.channels.get("alpha")):
        return 0.0
    return _at_start(Signal(alpha.t - start, alpha.y), first)


def _at_start(out: Signal, first_step_s: float) -> float:
    """Return the mean of an output before the first step, or over at least its first 0.1 s."""
    return float(np.mean(out.y[out.t <= max(first_step_s, out.t[0] + 0.1)]))


def _with_rows(flight: PreparedManeuver, channels: Sequence[str]) -> PreparedManeuver:
    """Return the manoeuvre with the stamps of its channels one after another."""
    times = [flight.outputs[c].t for c in channels]
    output = np.repeat([OUTPUTS.index(c) for c in channels], [len(t) for t in times])
    return replace(flight, stamps=np.concatenate(times), output=output.astype(np.int64))


_TOGETHER = {"a_z": ("a_z", "a_x")}
"""Channels of one message, by the name of the channel in the findings."""


def as_stamped(maneuver: Maneuver) -> Maneuver:
    """Return the manoeuvre with the delays that were removed from its channels put back.

    The removed delays differ between manoeuvres, so the diagnosis finds a late stream itself.
    """
    channels = dict(maneuver.channels)
    for finding in maneuver.findings:
        for name in _TOGETHER.get(finding.channel, (finding.channel,)):
            if name in channels and finding.removed_s:
                channels[name] = replace(channels[name], t=channels[name].t + finding.removed_s)
    findings = tuple(replace(finding, removed_s=0.0) for finding in maneuver.findings)
    return replace(maneuver, channels=channels, findings=findings)
