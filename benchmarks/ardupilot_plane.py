"""Does ArduPilot's own plane fly as the flight did, once it has the exported file?

    python -m benchmarks.ardupilot_plane FLIGHT.tlog [--axis lateral] [--truth FILE.yaml]

The recorded servo outputs are replayed, manoeuvre by manoeuvre, through the plane of ArduPilot's simulation.
Its formulas are written anew here from its source (``libraries/SITL/SIM_Plane.cpp``, ``ServoModel.cpp``), as
is the loader of its file, so that nothing but the two files is shared with the export. The aircraft file
stands next to the log, with the ending ``.yaml``. Printed is the largest error of the rotation rate, in per
cent of its largest value, as the mean over the manoeuvres: with the aircraft file as it is, with the finding
of ``gap`` or ``analyze``, and with the truth, where a file gives it. The last one is the floor.
"""

import json
import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import click
import numpy as np
from pymavlink import mavutil
from scipy.optimize import fsolve

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS, Reference
from advisor.analysis.axis_flown import accepted_of, compare_side_flown
from advisor.analysis.gap import compare_logs
from advisor.analysis.gap_flights import maneuvers_of
from advisor.analysis.whole_flights import read_whole
from advisor.cli.options import read_aircraft
from advisor.exports.models.axes.handed_over import improved_side
from advisor.exports.models.flown import FlownModel, SideModel, improved_model
from advisor.exports.models.improvement import Improvement, servo_of
from advisor.exports.models.write import carry_out, order_of
from advisor.flight.instruments.atmosphere import AirData
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.gap.result import Value
from advisor.model.axes.lateral import Trim

STEP_S = 1.0 / 400.0
GRAVITY = 9.80665
AFTER_S = 2.0
"""Time after the last step that is compared, s."""
SKYWALKER = {
    "s": 0.45, "b": 1.88, "c": 0.24, "c_lift_0": 0.56, "c_lift_deltae": 0.0, "c_lift_a": 6.9, "c_lift_q": 0.0,
    "mcoeff": 50.0, "oswald": 0.9, "alpha_stall": 0.4712, "c_drag_q": 0.0, "c_drag_deltae": 0.0,
    "c_drag_p": 0.1, "c_y_0": 0.0, "c_y_b": -0.98, "c_y_p": 0.0, "c_y_r": 0.0, "c_y_deltaa": 0.0,
    "c_y_deltar": -0.2, "c_l_0": 0.0, "c_l_p": -1.0, "c_l_b": -0.12, "c_l_r": 0.14, "c_l_deltaa": 0.25,
    "c_l_deltar": -0.037, "c_m_0": 0.045, "c_m_a": -0.7, "c_m_q": -20.0, "c_m_deltae": 1.0, "c_n_0": 0.0,
    "c_n_b": 0.25, "c_n_p": 0.022, "c_n_r": -1.0, "c_n_deltaa": 0.0, "c_n_deltar": 0.1,
}  # fmt: skip
"""Numbers of ArduPilot's own plane, which stay where a file lacks the key."""
MASS_KG = 2.0
REFERENCE = Reference(
    mass_kg=2.0, wing_area_m2=0.45, chord_m=0.24, span_m=1.88, iyy_kg_m2=1.0, ixx_kg_m2=1.0, izz_kg_m2=1.0
)
"""Reference where the aircraft file gives none: the derivatives are what is compared."""
ALL_RATES = ("rollspeed", "pitchspeed", "yawspeed")
RATES = {"pitch": ("pitchspeed",), "lateral": ("rollspeed", "yawspeed")}


class Plane(Protocol):
    """A plane of another program."""

    def surfaces(self, pulses: np.ndarray) -> np.ndarray:
        """Return the departures of aileron, elevator and rudder for those of the pulses, us, shape (3, n)."""

    def accelerations(self, x: np.ndarray, u: tuple[float, float, float]) -> np.ndarray:
        """Return the specific force without thrust (m/s²) and the angular acceleration, shape (6,).

        ``x`` is (u, v, w, p, q, r) in m/s and rad/s, ``u`` the surfaces.
        """


@dataclass(frozen=True)
class ArduPlane:
    """The plane and the servos as ArduPilot reads them."""

    plane: Mapping[str, float]
    servo: Mapping[str, float]
    rho: float

    def surfaces(self, pulses: np.ndarray) -> np.ndarray:
        """Return the numbers from -1 to 1 behind the servos."""
        return np.array([moved(self.servo, row / 500.0) for row in pulses])

    def accelerations(self, x: np.ndarray, u: tuple[float, float, float]) -> np.ndarray:
        """Return the accelerations of 2 kg and 1 kg m²."""
        found = forces(self.plane, x, u, self.rho)
        return np.concatenate([found[:3] / MASS_KG, found[3:]])


def loaded(json_file: Path, rho: float) -> ArduPlane:
    """Read both files: JSON from the first brace without comments, and lines of a name and a number."""
    text = json_file.read_text(encoding="utf-8")
    lines = (line.split("#")[0] for line in text[text.index("{") :].splitlines())
    plane = {k: v for k, v in json.loads("\n".join(lines)).items() if k != "CGOffset"}
    said = json_file.with_suffix(".parm").read_text(encoding="utf-8").splitlines()
    pairs = (line.split() for line in said if line and not line.startswith("#"))
    return ArduPlane(SKYWALKER | plane, {name: float(value) for name, value in pairs}, rho)


def forces(c: Mapping[str, float], x: np.ndarray, u: tuple[float, float, float], rho: float) -> np.ndarray:
    """Return the body forces (N) and angular accelerations of the plane, shape (6,).

    ``x`` is (u, v, w, p, q, r) in m/s and rad/s, ``u`` aileron, elevator and rudder from -1 to 1.
    """
    speed = float(np.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2))
    alpha, beta = math.atan2(x[2], x[0]), math.atan2(x[1], x[0])
    p, q, r = x[3:]
    aileron, elevator, rudder = u
    pressure = 0.5 * rho * speed**2 * c["s"]
    long, wide = c["c"] / (2.0 * speed), c["b"] / (2.0 * speed)
    lift = c["c_lift_0"] + c["c_lift_a"] * alpha
    drag = c["c_drag_p"] + lift**2 / (math.pi * c["oswald"] * c["b"] ** 2 / c["s"])
    lift += c["c_lift_q"] * long * q + c["c_lift_deltae"] * elevator
    sin, cos = math.sin(alpha), math.cos(alpha)

    def sideways(letter: str) -> float:
        turning = wide * (c[f"c_{letter}_p"] * p + c[f"c_{letter}_r"] * r)
        moving = c[f"c_{letter}_deltaa"] * aileron + c[f"c_{letter}_deltar"] * rudder
        return c[f"c_{letter}_0"] + c[f"c_{letter}_b"] * beta + turning + moving

    pitch = c["c_m_0"] + c["c_m_a"] * alpha + c["c_m_q"] * long * q + c["c_m_deltae"] * elevator
    return pressure * np.array(
        [
            -drag * cos + lift * sin, sideways("y"), -drag * sin - lift * cos,
            c["b"] * sideways("l"), c["c"] * pitch, c["b"] * sideways("n"),
        ]
    )  # fmt: skip


def moved(servo: Mapping[str, float], command: np.ndarray) -> np.ndarray:
    """Return the surface of a command from -1 to 1 at ``STEP_S``, by ArduPilot's servo model, shape (n,)."""
    speed, delay, cutoff = (servo.get(f"SIM_SERVO_{n}", 0.0) for n in ("SPEED", "DELAY", "FILTER"))
    out = command.astype(float)
    if delay <= 0.0 and cutoff <= 0.0:
        if speed <= 0.0:
            return out
        share = STEP_S / (STEP_S + speed)
        for k in range(1, len(out)):
            out[k] = out[k - 1] + share * (command[k] - out[k - 1])
        return out
    late = round(delay / STEP_S)
    out = np.concatenate([np.full(late, out[0]), out[: len(out) - late]]) if late else out
    if speed > 0.0:
        most = STEP_S / (45.0 * speed / 60.0)
        for k in range(1, len(out)):
            out[k] = out[k - 1] + np.clip(out[k] - out[k - 1], -most, most)
    if cutoff > 0.0:
        w, y, rate = 2.0 * math.pi * cutoff, out[0], 0.0
        for k in range(len(out)):
            rate += STEP_S * (w**2 * (out[k] - y) - math.sqrt(2.0) * w * rate)
            y += STEP_S * rate
            out[k] = y
    return out


def flown(plane: Plane, t: np.ndarray, pulses: np.ndarray, speed: float, bank: float) -> np.ndarray:
    """Return p, q and r at ``t``, shape (3, n), by departures of the pulses (3, n), us, from a trim."""

    def unbalanced(at: np.ndarray) -> list[float]:
        alpha, elevator, thrust = at
        x = np.array([speed * math.cos(alpha), 0.0, speed * math.sin(alpha), 0.0, 0.0, 0.0])
        f = plane.accelerations(x, (0.0, elevator, 0.0))
        return [
            f[0] + thrust - GRAVITY * math.sin(alpha),
            f[2] + GRAVITY * math.cos(alpha) * math.cos(bank),
            f[4],
        ]

    alpha, elevator, thrust = fsolve(unbalanced, [0.03, 0.0, 2.5])
    x = np.array([speed * math.cos(alpha), 0.0, speed * math.sin(alpha), 0.0, 0.0, 0.0])
    phi, theta = bank, float(alpha)
    moves = plane.surfaces(pulses)
    out = np.zeros((3, len(t)))
    for k in range(len(t)):
        out[:, k] = x[3:]
        rate = plane.accelerations(x, (moves[0][k], elevator + moves[1][k], moves[2][k]))
        rate[0] += thrust - GRAVITY * math.sin(theta)
        rate[1] += GRAVITY * math.cos(theta) * math.sin(phi)
        rate[2] += GRAVITY * math.cos(theta) * math.cos(phi)
        rate[:3] -= np.cross(x[3:], x[:3])
        turn = x[4] * math.sin(phi) + x[5] * math.cos(phi)
        phi += STEP_S * (x[3] + math.tan(theta) * turn)
        theta += STEP_S * (x[4] * math.cos(phi) - x[5] * math.sin(phi))
        x = x + STEP_S * rate
    return out


class Log:
    """Servo outputs and rates of a log, by pymavlink."""

    def __init__(self, path: Path) -> None:
        rows: dict[str, list[Any]] = {"SERVO_OUTPUT_RAW": [], "ATTITUDE": []}
        reader = mavutil.mavlink_connection(str(path))
        while (m := reader.recv_match(type=list(rows))) is not None:
            rows[m.get_type()].append(m)
        outputs, attitudes = rows.values()
        self.t_out = np.array([1e-6 * m.time_usec for m in outputs])
        self.pulses = {n: np.array([getattr(m, f"servo{n}_raw") for m in outputs]) for n in range(1, 9)}
        self.t = np.array([1e-3 * m.time_boot_ms for m in attitudes])
        self.rates = {
            n: np.array([getattr(m, n) for m in attitudes]) for n in ("rollspeed", "pitchspeed", "yawspeed")
        }
        self.bank = np.array([m.roll for m in attitudes])


def errors(
    plane: Plane,
    log: Log,
    flights: Sequence[tuple[Span, float]],
    outputs: Mapping[str, int],
    axis: str,
) -> dict[str, float]:
    """Return by rate the mean over the manoeuvres of the largest error, % of the largest measured value.

    ``flights`` has each manoeuvre with its true air speed.
    """
    found: dict[str, list[float]] = {name: [] for name in RATES[axis]}
    for span, speed in flights:
        begin, end = span.start_s - 1.0, min(span.last_step_s + AFTER_S, span.end_s)
        t = np.arange(begin, end, STEP_S)
        before = (log.t >= begin) & (log.t < span.start_s)
        rows = []
        for name in ("aileron", "elevator", "rudder"):
            pulse = np.interp(t, log.t_out, log.pulses[outputs[name]])
            rows.append(pulse - pulse[t < span.start_s].mean())
        told = flown(plane, t, np.array(rows), speed, float(log.bank[before].mean()))
        inside = (log.t >= begin) & (log.t <= t[-1])
        for name in RATES[axis]:
            simulated = np.interp(log.t[inside], t, told[ALL_RATES.index(name)])
            measured = log.rates[name][inside] - log.rates[name][before].mean()
            found[name].append(float(np.max(np.abs(simulated - measured)) / np.max(np.abs(measured))))
    return {name: 100.0 * float(np.mean(values)) for name, values in found.items()}


def exported(model: FlownModel, folder: Path, name: str, rho: float) -> Plane:
    """Export a model for ArduPilot, and read the files back as ArduPilot does."""
    (outcome,) = carry_out([order_of(f"ardupilot:{folder / name}.json")], model)
    if outcome.problem:
        raise click.ClickException(outcome.problem)
    return loaded(folder / f"{name}.json", rho)


def of_file(aircraft: Aircraft, air: AirData, read_m_s: float, axis: str) -> FlownModel:
    """Return an aircraft file's own numbers as a model of one axis; what it leaves open is zero."""
    speed = (aircraft.reference_airspeed_m_s or read_m_s / air.true_over_read) * air.true_over_read
    if axis == "lateral":
        values = {n: Value(aircraft.model.get(n, 0.0), 0.0) for n in SIDE_PARAMETERS}
        servos = {n: servo_of(getattr(aircraft, n), {}) for n in ("aileron", "rudder")}
        return FlownModel(aircraft, None, SideModel(values, {}, Trim(speed), air, servos))
    weight = GRAVITY / air.true_speed(speed)
    usual = {"Z_0": weight, "M_0": 0.0}
    values = {n: Value(aircraft.model.get(n, usual.get(n, 0.0)), 0.0) for n in PARAMETERS}
    pitch = Improvement(
        aircraft.name, values, {}, speed, servo_of(aircraft.elevator, {}), {}, aircraft.reference,
        aircraft.elevator, air,
    )  # fmt: skip
    return FlownModel(aircraft, pitch, None)


@dataclass(frozen=True)
class Compared:
    """The manoeuvres of one axis, and the models that fly them."""

    maneuvers: Sequence[Maneuver]
    air: AirData
    models: Mapping[str, FlownModel]


def compared(log: Path, aircraft: Aircraft, truth: Path | None, axis: str) -> Compared:
    """Return the models of the file, of the finding, and of the truth where a file states it."""
    if axis == "pitch":
        maneuvers: Sequence[Maneuver] = maneuvers_of([log], aircraft).maneuvers
        after = improved_model(
            compare_logs([log], replace(aircraft, simulator=None)).diagnosis, aircraft, None
        )
        assert after.pitch is not None
        air, after = after.pitch.air, replace(after, side=None)
    else:
        found = compare_side_flown(read_whole([log], aircraft, axis="lateral").state, aircraft)
        maneuvers, after = accepted_of(found.state), improved_side(found)
        assert after.side is not None
        air, after = after.side.air, replace(after, pitch=None)
    flown_m_s = float(np.mean([np.mean(m.channels["airspeed"].y) for m in maneuvers]))
    models = {"before": of_file(aircraft, air, flown_m_s, axis), "after": after}
    if truth is not None:
        stated = replace(read_aircraft(truth), reference=aircraft.reference)
        models["floor"] = of_file(stated, air, flown_m_s, axis)
    return Compared(maneuvers, air, models)


@click.command
@click.argument("log", type=click.Path(exists=True, path_type=Path))
@click.option("--axis", type=click.Choice(["pitch", "lateral"]), default="pitch", show_default=True)
@click.option("--truth", type=click.Path(exists=True, path_type=Path), help="Aircraft file with the truth.")
@click.option(
    "--file", "aircraft_file", type=click.Path(exists=True, path_type=Path), help="Instead of LOG.yaml."
)
def main(log: Path, axis: str, truth: Path | None, aircraft_file: Path | None) -> None:
    """Fly the exported files, and print the errors."""
    print_errors(exported, log, axis, truth, aircraft_file)


def print_errors(
    export: Callable[[FlownModel, Path, str, float], Plane],
    log: Path,
    axis: str,
    truth: Path | None,
    aircraft_file: Path | None,
) -> None:
    """Fly the planes that an export makes of the file, of the finding and of the truth."""
    aircraft = read_aircraft(aircraft_file or log.with_suffix(".yaml"))
    if aircraft.reference.mass_kg is None:
        aircraft = replace(aircraft, reference=REFERENCE)
    outputs = {"aileron": 1, "elevator": 2, "rudder": 4}
    outputs |= {n: o for n in outputs if isinstance(o := getattr(aircraft, n).output, int)}
    found, recorded = compared(log, aircraft, truth, axis), Log(log)
    speeds = [found.air.true_speed(float(np.mean(m.channels["airspeed"].y))) for m in found.maneuvers]
    flights = list(zip([m.span for m in found.maneuvers], speeds, strict=True))
    with tempfile.TemporaryDirectory() as folder:
        for name, model in found.models.items():
            plane = export(model, Path(folder), name, found.air.density_kg_m3)
            told = errors(plane, recorded, flights, outputs, axis)
            click.echo(f"{name:8}" + "".join(f"  {rate} {value:6.1f} %" for rate, value in told.items()))


if __name__ == "__main__":
    main()
