"""Does Gazebo's aircraft fly as the flight did, once it has the exported plugins?

    python -m benchmarks.gazebo_plane FLIGHT.tlog [--axis lateral] [--truth FILE.yaml]

As ``benchmarks.ardupilot_plane``, with the formulas of Gazebo's ``LiftDrag`` and ``AdvancedLiftDrag``
written anew from their source (``src/systems``). The plugins are read by an XML parser. The servo of each
joint, which no plugin has, is a first-order lag with the time that the export says. On the lateral axis the
plugins of pitch are missing, so that a wing and a tail of this file carry the weight.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.write import carry_out, order_of
from benchmarks.ardupilot_plane import Plane, moved, print_errors

WING, TAIL = ({"a0": 0.05, "cla": 4.5, "ahead": 0.0}, {"a0": 0.0, "cla": 0.9, "ahead": -0.8})
"""Wing and tail where the export has none."""
JOINTS = ("aileron_joint", "elevator_joint", "rudder_joint")


@dataclass(frozen=True)
class Surface:
    """A ``LiftDrag`` plugin: a lift at its centre of pressure, in the air that it meets."""

    zero_rad: float
    slope: float
    ahead_m: float
    control: float
    weight: float
    """Half of the air density times the area, kg/m."""

    def lift(self, x: np.ndarray, elevator: float) -> tuple[np.ndarray, float]:
        """Return the force in body axes, N, and its pitching moment, N m."""
        ahead, down = x[0], x[2] - x[4] * self.ahead_m
        c = self.slope * (self.zero_rad + math.atan2(down, ahead)) + self.control * elevator
        speed = math.hypot(ahead, down)
        size = self.weight * speed**2 * c
        force = size * np.array([down, 0.0, -ahead]) / speed
        return force, -self.ahead_m * force[2]


@dataclass(frozen=True)
class GazeboPlane:
    """The plugins on a link with the aircraft's mass and inertias."""

    surfaces_of_pitch: tuple[Surface, ...]
    side: Mapping[str, float]
    joints: Mapping[str, Mapping[str, float]]
    aircraft: Aircraft
    lags_s: Mapping[str, float]

    def surfaces(self, pulses: np.ndarray) -> np.ndarray:
        """Return the joints' departures, rad, behind the servos."""
        rows = []
        for name, row in zip(("aileron", "elevator", "rudder"), pulses, strict=True):
            pairs = getattr(self.aircraft, name).calibration or ((1000.0, 0.0), (2000.0, 0.0))
            (low_us, low), (high_us, high) = min(pairs), max(pairs)
            per_us = math.radians(high - low) / (high_us - low_us)
            rows.append(moved({"SIM_SERVO_SPEED": self.lags_s.get(name, 0.0)}, per_us * row))
        return np.array(rows)

    def accelerations(self, x: np.ndarray, u: tuple[float, float, float]) -> np.ndarray:
        """Return the specific force and the angular acceleration by all plugins."""
        reference = self.aircraft.reference
        force, moments = np.zeros(3), np.zeros(3)
        for surface in self.surfaces_of_pitch:
            lift, pitching = surface.lift(x, u[1])
            force += lift
            moments[1] += pitching
        if self.side:
            across, roll, yaw = self._side(x, u)
            force[1] += across
            moments += [roll, 0.0, yaw]
        ixx, iyy, izz = (getattr(reference, f"i{a}{a}_kg_m2") or 1.0 for a in "xyz")
        ixz = reference.ixz_kg_m2 or 0.0
        p, r = np.linalg.solve([[ixx, -ixz], [-ixz, izz]], moments[[0, 2]])
        return np.concatenate([force / (reference.mass_kg or 1.0), [p, moments[1] / iyy, r]])

    def _side(self, x: np.ndarray, u: tuple[float, float, float]) -> list[float]:
        c = self.side
        in_plane = math.hypot(x[0], x[2])
        span = math.sqrt(c["area"] * c["AR"])
        beta, turn = math.atan2(x[1], x[0]), span / (2.0 * in_plane)
        pressure = 0.5 * c["air_density"] * in_plane**2 * c["area"]
        angles = dict(zip(JOINTS, np.degrees(u), strict=True))
        found = []
        for name, arm in (("CY", 1.0), ("Cell", span), ("Cen", span)):
            by_joint = sum(
                angles[j] * one["direction"] * one[f"{name}_ctrl"] for j, one in self.joints.items()
            )
            by_motion = c[f"{name}b"] * beta + turn * (c[f"{name}p"] * x[3] + c[f"{name}r"] * x[5])
            found.append(pressure * arm * (by_motion + by_joint))
        return found


def exported(model: FlownModel, folder: Path, name: str, rho: float) -> Plane:
    """Export a model for Gazebo, and read the plugins back."""
    file = folder / f"{name}.sdf"
    (outcome,) = carry_out([order_of(f"sdf:{file}")], model)
    if outcome.problem:
        raise click.ClickException(outcome.problem)
    area = model.aircraft.reference.wing_area_m2 or 1.0
    pitch: list[Surface] = []
    side: dict[str, float] = {}
    joints: dict[str, dict[str, float]] = {}
    for plugin in ET.fromstring(f"<model>{file.read_text(encoding='utf-8')}</model>").findall("plugin"):
        if (plugin.get("name") or "").endswith("AdvancedLiftDrag"):
            side = {e.tag: float(e.text or 0) for e in plugin if e.tag[0] in "CAae" and e.tag != "cp"}
            for one in plugin.iter("control_surface"):
                numbers = {e.tag: float(e.text or 0) for e in one if e.tag != "name"}
                joints[one.findtext("name") or ""] = numbers
        else:
            pitch.append(_surface({e.tag: e.text or "" for e in plugin}))
    if not pitch:
        own = (
            (one["a0"], one["cla"], one["ahead"], 0.5 if one["ahead"] else 0.0, 0.5 * rho * area)
            for one in (WING, TAIL)
        )
        pitch = [Surface(*numbers) for numbers in own]
    lags = {"elevator": model.pitch.servo.lag_s} if model.pitch else {}
    lags |= {n: s.lag_s for n, s in model.side.servos.items()} if model.side else {}
    return GazeboPlane(tuple(pitch), side, joints, model.aircraft, lags)


def _surface(text: Mapping[str, str]) -> Surface:
    """Return a ``LiftDrag`` plugin."""
    return Surface(
        zero_rad=float(text["a0"]),
        slope=float(text["cla"]),
        ahead_m=float(text["cp"].split()[0]),
        control=float(text.get("control_joint_rad_to_cl", 0.0)),
        weight=0.5 * float(text["air_density"]) * float(text["area"]),
    )


@click.command
@click.argument("log", type=click.Path(exists=True, path_type=Path))
@click.option("--axis", type=click.Choice(["pitch", "lateral"]), default="pitch", show_default=True)
@click.option("--truth", type=click.Path(exists=True, path_type=Path), help="Aircraft file with the truth.")
@click.option("--file", "aircraft_file", type=click.Path(exists=True, path_type=Path), help="Not LOG.yaml.")
def main(log: Path, axis: str, truth: Path | None, aircraft_file: Path | None) -> None:
    """Fly the exported plugins, and print the errors."""
    print_errors(exported, log, axis, truth, aircraft_file)


if __name__ == "__main__":
    main()
