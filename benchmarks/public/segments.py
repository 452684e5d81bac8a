"""Segments of the benchmark's files (``sysid.timeseries.ragged.v1``), and as manoeuvres of the advisor.

A file holds segments of states and commands at one rate: position, velocity in body axes, quaternion from
body to earth, and angular rates. Names say north, east, down, but the motion says that z points up and y to
the left. Commands have no unit, and a full stroke counts as 25 deg. Specific forces are the derivative of the
velocity less gravity.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.axes.side_instruments import examine_side
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

STATES = ("x_n", "y_e", "z_d", "u", "v", "w", "q_w", "q_x", "q_y", "q_z", "p", "q", "r")
CONTROLS = ("throttle", "elevator", "aileron", "rudder")
UPRIGHT = np.array([1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1], dtype=float)
"""Sign of each state when body and earth axes turn half a turn about x."""
STROKE_RAD = np.radians(25.0)
"""Deflection that counts as a full stroke, rad. The files state none, and predictions do not depend on it."""


@dataclass(frozen=True)
class Segment:
    """One stretch of flight."""

    name: str
    t: FloatArray
    """(n,) stamps, s."""
    states: FloatArray
    """(n, 13) in the order of ``STATES``."""
    commands: Mapping[str, FloatArray]
    """Control to its command, (n,), as in the file."""


def read_segments(path: Path) -> list[Segment]:
    """Read the segments of a file.

    Raises
    ------
    ValueError
        The file lacks a state or a command.
    """
    with np.load(path, allow_pickle=False) as file:
        named = [str(name) for name in file["state_names"]]
        inputs = [str(name) for name in file["input_names"]]
        missing = [name for name in STATES if name not in named] + [n for n in CONTROLS if n not in inputs]
        if missing:
            raise ValueError(f"{path} lacks {', '.join(missing)}: it holds {', '.join([*named, *inputs])}")
        order = [named.index(name) for name in STATES]
        return [
            Segment(
                str(name),
                t[valid] - t[valid][0],
                x[valid][:, order],
                {control: u[valid][:, inputs.index(control)] for control in CONTROLS},
            )
            for name, t, valid, x, u in zip(
                file["segment_names"],
                file["time_s"],
                file["valid_mask"],
                file["x_meas"],
                file["u_cmd"],
                strict=True,
            )
        ]


def upright(segment: Segment) -> Segment:
    """Return the segment with y and z of body and earth reversed: right and down where left and up were."""
    return replace(segment, states=segment.states * UPRIGHT)


def rolled(segment: Segment) -> Segment:
    """Return the segment with roll angle and roll rate reversed, as in the telemetry log of these flights.

    For roll and yaw alone this is the mirror image of ``upright``.
    """
    bank, pitch, heading = angles(segment.states[:, 6:10])
    states = segment.states.copy()
    states[:, 6:10] = quaternions(-bank, pitch, heading)
    states[:, 10] *= -1.0
    return replace(segment, states=states)


def is_rolled(maneuvers: Sequence[Maneuver]) -> bool:
    """Return whether the roll axis of most records contradicts the side force and the sideslip."""
    found = [any(f.code == "bank_sign" for f in examine_side(m.channels).findings) for m in maneuvers]
    return sum(found) > 0.5 * len(found)


def maneuver_of(segment: Segment, number: int) -> Maneuver:
    """Return a segment as a manoeuvre of the advisor, marked by hand."""
    t, x = segment.t, segment.states
    bank, pitch, _ = angles(x[:, 6:10])
    velocity, rates = x[:, 3:6], x[:, 10:13]
    speed = np.linalg.norm(velocity, axis=1)
    gravity = GRAVITY_M_S2 * np.column_stack(
        [-np.sin(pitch), np.cos(pitch) * np.sin(bank), np.cos(pitch) * np.cos(bank)]
    )
    force = np.gradient(velocity, t, axis=0) + np.cross(rates, velocity) - gravity
    measured = {
        "alpha": np.arctan2(velocity[:, 2], velocity[:, 0]), "beta": np.arcsin(velocity[:, 1] / speed),
        "airspeed": speed, "theta": pitch, "bank": bank, "p": rates[:, 0], "q": rates[:, 1], "r": rates[:, 2],
        "a_x": force[:, 0], "a_y": force[:, 1], "a_z": force[:, 2],
    }  # fmt: skip
    channels = {name: Channel(name, t, y, "HIGHRES_IMU", "vane") for name, y in measured.items()}
    for control in ("elevator", "aileron", "rudder"):
        y = STROKE_RAD * segment.commands[control]
        channels[control] = Channel(control, t, y, "SERVO_OUTPUT_RAW", "commanded")
    end_s = float(t[-1])
    return Maneuver(number, 0, Span(0.0, 0.0, end_s, end_s, "other", (), "marked by hand"), channels)


def angles(quaternion: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return bank, pitch and heading, rad, (n,) each, of quaternions (n, 4)."""
    w, x, y, z = quaternion.T
    bank = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    heading = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return bank, pitch, heading


def quaternions(bank: FloatArray, pitch: FloatArray, heading: FloatArray) -> FloatArray:
    """Return quaternions (n, 4) of bank, pitch and heading, rad, (n,) each."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(0.5 * a), np.sin(0.5 * a)) for a in (bank, pitch, heading))
    return np.column_stack(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )
