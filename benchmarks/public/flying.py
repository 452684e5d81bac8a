"""Our two linear axes flown together: fitted on training segments, then simulated with the commands alone.

Short period and lateral axis are the advisor's own estimates. The benchmark also scores speed and place, of
which the advisor has no model. The speed follows V̇ + g·sin γ = X_0 + X_V·(V/V_ref)² + X_T·throttle, by
least squares on the training segments. Attitude and place follow from kinematics.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.sensors import Alpha, Beta
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.library import estimate
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.oem.axes.lateral.estimator import estimate_lateral
from advisor.oem.estimate import Estimate, NoEstimate
from benchmarks.public.segments import (
    STROKE_RAD,
    FloatArray,
    Segment,
    angles,
    is_rolled,
    maneuver_of,
    quaternions,
    rolled,
)

AIRCRAFT = Aircraft(alpha=Alpha("aoa_ssa", 0.0), beta=Beta("aoa_ssa", 0.0))
"""Angles of attack and sideslip are measured at the centre of gravity."""
LARGEST = 50.0
"""Size of a rate, 1/s, at which a simulation has run away and is held."""


@dataclass(frozen=True)
class Flyer:
    """Everything that a simulation needs."""

    pitch: Mapping[str, float]
    side: Mapping[str, float]
    thrust: FloatArray
    """X_0, X_V and X_T, m/s²."""
    reference_m_s: float
    lags_s: Mapping[str, float]
    """Lag of each control's servo, s."""
    rolled: bool
    """Whether the file's roll axis is reversed."""
    untold: tuple[str, ...]
    """Derivatives that the training segments do not tell."""


def fitted(train: Sequence[Segment]) -> Flyer | NoEstimate:
    """Return the aircraft as the training segments tell it, or why they do not."""
    by_control: dict[str, list[Segment]] = {"elevator": [], "side": []}
    for segment in train:
        motion = {name: float(np.ptp(segment.commands[name])) for name in ("elevator", "aileron", "rudder")}
        moved = max(motion, key=lambda name: motion[name])
        if motion[moved] > 0.0:
            by_control["elevator" if moved == "elevator" else "side"].append(segment)
    turned = is_rolled([maneuver_of(s, n) for n, s in enumerate(by_control["side"])])
    if turned:
        by_control = {name: list(map(rolled, segments)) for name, segments in by_control.items()}
    flown = {name: [maneuver_of(s, n) for n, s in enumerate(some, 1)] for name, some in by_control.items()}
    pitch = estimate(flown["elevator"], AIRCRAFT)
    side = estimate_lateral(flown["side"], AIRCRAFT)
    if isinstance(pitch, NoEstimate) or isinstance(side, NoEstimate):
        return pitch if isinstance(pitch, NoEstimate) else side  # type: ignore[return-value]
    return _flyer(pitch, side, [maneuver_of(s, 0) for s in train], train, turned)


def _flyer(
    pitch: Estimate,
    side: LateralEstimate,
    flown: Sequence[Maneuver],
    train: Sequence[Segment],
    turned: bool,
) -> Flyer:
    mean_m_s = float(np.mean([np.mean(one.channels["airspeed"].y) for one in flown]))
    reference = pitch.airspeed_m_s or mean_m_s
    rows, left = [], []
    for maneuver, segment in zip(flown, train, strict=True):
        channels = maneuver.channels
        speed = channels["airspeed"].y
        climb = np.sin(channels["theta"].y - channels["alpha"].y)
        left.append(np.gradient(speed, segment.t) + GRAVITY_M_S2 * climb)
        rows.append(
            np.column_stack([np.ones(len(speed)), (speed / reference) ** 2, segment.commands["throttle"]])
        )
    thrust = np.linalg.lstsq(np.concatenate(rows), np.concatenate(left), rcond=None)[0]
    ratio = reference / (side.airspeed_m_s or reference)
    powers = {"beta": 2, "p": 1, "r": 1, "delta_a": 2, "delta_r": 2}
    scaled = {
        name: float(value) * ratio ** (powers[name[2:]] - (name[0] == "Y"))
        for name, value in zip(side.names, side.theta, strict=True)
    }
    lags = {name: side.nuisances.get(f"{name}_lag_s", (0.0, 0.0))[0] for name in ("aileron", "rudder")}
    return Flyer(
        {name: pitch.value(name) for name in pitch.names},
        scaled,
        thrust,
        reference,
        {**lags, "elevator": pitch.servo_lag_s},
        turned,
        (*pitch.not_identifiable, *side.not_identifiable),
    )


def simulated(flyer: Flyer, segment: Segment) -> FloatArray:
    """Return the states (n, 13) from the first measured ones, with the commands alone."""
    begun = rolled(segment) if flyer.rolled else segment
    first = begun.states[0]
    bank, pitch, heading = (float(a[0]) for a in angles(first[None, 6:10]))
    velocity = first[3:6]
    speed = float(np.linalg.norm(velocity))
    x = np.array(
        [speed, np.arctan2(velocity[2], velocity[0]), np.arcsin(velocity[1] / speed), *first[10:13],
         bank, pitch, heading, *first[:3]]
    )  # fmt: skip
    moved = _moved(flyer, segment)
    found = [x]
    for i, step in enumerate(np.diff(segment.t)):
        x = _stepped(flyer, x, moved[i], float(step))
        found.append(x)
    return _as_states(np.array(found), segment, flyer.rolled)


def _moved(flyer: Flyer, segment: Segment) -> FloatArray:
    """Return throttle, elevator, aileron and rudder after their servos, (n, 4), rad."""
    columns = [segment.commands["throttle"]]
    for name in ("elevator", "aileron", "rudder"):
        command, lag_s = STROKE_RAD * segment.commands[name], flyer.lags_s[name]
        if lag_s > 0.0:
            after = command.copy()
            for i, step in enumerate(np.diff(segment.t)):
                after[i + 1] = after[i] + (1.0 - np.exp(-step / lag_s)) * (command[i] - after[i])
            command = after
        columns.append(command)
    return np.column_stack(columns)


def _stepped(flyer: Flyer, x: FloatArray, moved: FloatArray, step_s: float) -> FloatArray:
    """Return the state after a step of the classical Runge-Kutta method."""
    k1 = _rates(flyer, x, moved)
    k2 = _rates(flyer, x + 0.5 * step_s * k1, moved)
    k3 = _rates(flyer, x + 0.5 * step_s * k2, moved)
    k4 = _rates(flyer, x + step_s * k3, moved)
    return np.asarray(x + step_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4))


def _rates(flyer: Flyer, x: FloatArray, moved: FloatArray) -> FloatArray:
    speed, alpha, beta, p, q, r, bank, pitch, heading = x[:9]
    throttle, elevator, aileron, rudder = moved
    z, d, s = flyer.pitch, flyer.side, max(speed / flyer.reference_m_s, 0.2)
    climb = pitch - alpha * np.cos(bank)
    weight = GRAVITY_M_S2 / (s * flyer.reference_m_s)
    along = flyer.thrust @ (1.0, s**2, throttle) - GRAVITY_M_S2 * np.sin(climb)
    lift = s * (z["Z_0"] + z["Z_alpha"] * alpha + z["Z_delta_e"] * elevator) + (1.0 + z["Z_q"]) * q
    moment = s**2 * (z["M_0"] + z["M_alpha"] * alpha + z["M_delta_e"] * elevator) + s * z["M_q"] * q
    side = s * (d["Y_beta"] * beta + d["Y_delta_a"] * aileron + d["Y_delta_r"] * rudder)
    side += d["Y_p"] * p + d["Y_r"] * r + np.sin(alpha) * p - np.cos(alpha) * r
    roll, yaw = (
        s**2 * (d[f"{m}_beta"] * beta + d[f"{m}_delta_a"] * aileron + d[f"{m}_delta_r"] * rudder)
        + s * (d[f"{m}_p"] * p + d[f"{m}_r"] * r)
        for m in "LN"
    )
    turn = q * np.sin(bank) + r * np.cos(bank)
    steep = max(np.cos(pitch), 0.1)
    north, east = np.cos(heading + beta) * np.cos(climb), np.sin(heading + beta) * np.cos(climb)
    rates = [
        along,
        lift + weight * (np.cos(climb) * np.cos(bank) - 1.0),
        side + weight * np.cos(pitch) * np.sin(bank),
        roll, moment, yaw,
        p + np.tan(np.clip(pitch, -1.4, 1.4)) * turn, q * np.cos(bank) - r * np.sin(bank), turn / steep,
        speed * north, speed * east, -speed * np.sin(climb),
    ]  # fmt: skip
    return np.clip(rates, -LARGEST, LARGEST)


def _as_states(x: FloatArray, segment: Segment, turned: bool) -> FloatArray:
    """Return the simulation (n, 12) as the states of the file (n, 13), its roll axis as there."""
    speed, alpha, beta = x[:, 0], x[:, 1], x[:, 2]
    body = np.column_stack(
        [speed * np.cos(alpha) * np.cos(beta), speed * np.sin(beta), speed * np.sin(alpha) * np.cos(beta)]
    )
    quaternion = quaternions(x[:, 6], x[:, 7], x[:, 8])
    found = Segment(segment.name, segment.t, np.column_stack([x[:, 9:12], body, quaternion, x[:, 3:6]]), {})
    states = (rolled(found) if turned else found).states
    same = np.sum(states[:, 6:10] * segment.states[:, 6:10], axis=1) >= 0.0
    states[:, 6:10] *= np.where(same, 1.0, -1.0)[:, None]
    return states
