"""Facts of a log about its aircraft: outputs and their limits, air speed, pressure, angle of attack."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.elevator.axes.side_controls import SIDES, find_side_control
from advisor.flight.elevator.elevator_guess import Guess
from advisor.flight.maneuvers.events import ManeuverFlown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.parameters import Parameters
from advisor.flight.vehicle.surfaces import Scale, Surface
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.flight.vehicle.wiring import Wiring
from advisor.process.arrays import FloatArray
from advisor.words.problems import Problem, UnusableInputError

FLYING_SHARE = 0.5
"""Fraction of the 95th percentile of the air speed, above which an aircraft flies. A stall speed is above
half of the cruise speed; an aircraft on the ground reads a few m/s of wind."""
SLOWEST_M_S = 3.0
"""Air speed below which no fixed-wing aircraft of a flight test flies, m/s. A log whose air speed never
exceeds this value contains no flight."""
_GROUND_STATIONS_COMPONENT = 190
"""MAV_COMP_ID_MISSIONPLANNER: the component under which ground stations store the vehicle's parameters."""
_FRAMES = {
    1: "fixed wing",
    2: "quadrotor",
    19: "VTOL, tailsitter",
    20: "VTOL, tailsitter",
    21: "VTOL, tiltrotor",
    22: "VTOL, fixed rotor",
    23: "VTOL, tailsitter",
    24: "VTOL, tiltwing",
    25: "VTOL",
    16: "flapping wing",
}
"""Names of the aircraft types, by the value of MAV_TYPE in MAVLink's common.xml."""


@dataclass(frozen=True, slots=True)
class LogFacts:
    """Facts about an aircraft from one log of the aircraft."""

    vehicle: Vehicle
    elevator: Surface | Problem
    """Elevator, from the log's parameters and the aircraft file."""
    guess: Guess | None
    """Servo output that the pitch rate follows, if no parameter names the elevator."""
    wiring: Wiring
    """Functions of all servo outputs, from the log's parameters."""
    pulses_us: Mapping[int, tuple[float, float]]
    """Shortest and longest pulse of each servo output, us, by the output's number."""
    airspeed_m_s: tuple[float, float, float] | None
    """Percentiles 5, 50 and 95 of the air speed in flight, m/s. None: the log has no air speed."""
    pressure_pa: float | None
    """Median static pressure, Pa. None: the log has no static pressure."""
    alpha_source: str | None
    """Message and field of the angle of attack. None: the log has no angle of attack."""
    alpha_provenance: str
    """``vane``, ``derived``, ``simulated``, or ``unknown``."""
    maneuvers_m_s: tuple[float, ...]
    """Mean air speed of every manoeuvre, m/s. NaN: the manoeuvre has no air speed."""
    sides_unknown: Problem | None = None
    """Reason for which the outputs of aileron or rudder are unknown; None if they are known."""
    sides: Mapping[str, Surface] = field(default_factory=dict)
    """Outputs of aileron and rudder, by the control's name, if parameters or the aircraft file state them."""
    side_guesses: Mapping[str, Guess] = field(default_factory=dict)
    """Servo output that roll rate or yaw rate follows, by the control's name, if neither parameters nor the
    file state the output.
    """

    @property
    def frame(self) -> str:
        """Kind of the aircraft in words, from MAV_TYPE."""
        return _FRAMES.get(self.vehicle.type, f"MAV_TYPE {self.vehicle.type}")

    @property
    def outputs(self) -> tuple[int, ...]:
        """Servo outputs of the elevator, known or guessed. Empty if the elevator's outputs are unknown."""
        if isinstance(self.elevator, Surface):
            return self.elevator.outputs
        return (self.guess.output,) if self.guess else ()

    def stated_scale(self, output: int) -> Scale | None:
        """Return the limits of a servo output from the log's parameters; None if the log has none."""
        return self.wiring.scales.get(output) if output in self.wiring.known_directions else None


def facts_of(
    batches: Iterable[Sequence[Columns]], aircraft: Aircraft, target_system: int | None = None
) -> LogFacts:
    """Return the facts of a log about its aircraft.

    Parameters
    ----------
    target_system
        System id of the vehicle; None for the first vehicle that sends.

    Raises
    ------
    UnusableInputError
        The log holds no vehicle, or one that has no elevator by its kind.
    """
    stream, parameters = FlightStream(aircraft, target_system, lateral=True, guesses_sides=True), Parameters()
    events: list[object] = []
    speeds: dict[int, list[FloatArray]] = {}
    pressures: dict[int, list[FloatArray]] = {}
    pulses: dict[int, dict[int, tuple[float, float]]] = {}
    for batch in batches:
        events += stream.feed(batch)
        for part in batch:
            if part.name == "PARAM_VALUE":
                for name, _, stated in parameters.news(part):
                    parameters.keep((part.system, part.component), name, stated)
            elif part.name == "VFR_HUD":
                speeds.setdefault(part.system, []).append(np.asarray(part.fields["airspeed"], dtype=float))
            elif part.name == "SCALED_PRESSURE":
                hpa = np.asarray(part.fields["press_abs"], dtype=float)
                pressures.setdefault(part.system, []).append(100.0 * hpa)
            elif part.name == "SERVO_OUTPUT_RAW":
                _widen(pulses.setdefault(part.system, {}), part)
    events += stream.finish()
    vehicle = stream.vehicle
    if vehicle is None or vehicle.is_multicopter:
        raise UnusableInputError.of(stream.problems())
    mine = (vehicle.system, vehicle.component)
    alpha = stream.channels.get("alpha")
    wiring = parameters.wiring(
        [(vehicle.system, _GROUND_STATIONS_COMPONENT), mine], autopilot=vehicle.autopilot
    )
    sides = {name: find_side_control(name, getattr(aircraft, name), wiring) for name in SIDES}
    return LogFacts(
        vehicle=vehicle,
        elevator=stream.elevator,
        guess=stream.guess,
        wiring=wiring,
        pulses_us=pulses.get(vehicle.system, {}),
        airspeed_m_s=_in_flight(speeds.get(vehicle.system, [])),
        pressure_pa=_median(pressures.get(vehicle.system, [])),
        alpha_source=alpha.source if alpha else None,
        alpha_provenance=alpha.provenance if alpha else "unknown",
        maneuvers_m_s=tuple(_mean_speed(e.maneuver) for e in events if isinstance(e, ManeuverFlown)),
        sides_unknown=stream.sides_unknown,
        sides={name: surface for name, surface in sides.items() if surface is not None},
        side_guesses=_free_guesses(stream, {name for name, surface in sides.items() if surface is not None}),
    )


def _free_guesses(stream: FlightStream, stated: Collection[str]) -> dict[str, Guess]:
    """Return the guessed outputs of the controls that neither parameters nor the file state, without outputs
    of other controls.
    """
    surface = stream.elevator
    taken = set(surface.outputs) if isinstance(surface, Surface) else set()
    taken |= {stream.guess.output} if stream.guess is not None else set()
    guesses = {}
    for name, guess in stream.side_guesses.items():
        if name not in stated and guess.output not in taken:
            guesses[name] = guess
            taken.add(guess.output)
    return guesses


def _widen(ranges: dict[int, tuple[float, float]], part: Columns) -> None:
    """Widen the range of every output by the pulses of SERVO_OUTPUT_RAW messages."""
    ports = np.asarray(part.fields["port"])
    for port in np.unique(ports).tolist():
        for n in range(1, 17):
            column = part.fields.get(f"servo{n}_raw")
            if column is None:
                continue
            pulses = np.asarray(column, dtype=float)[ports == port]
            pulses = pulses[(pulses > 0.0) & (pulses < 65535.0)]
            if len(pulses):
                low, high = ranges.get(16 * port + n, (np.inf, -np.inf))
                ranges[16 * port + n] = (min(low, float(pulses.min())), max(high, float(pulses.max())))


def _in_flight(parts: Sequence[FloatArray]) -> tuple[float, float, float] | None:
    speeds = np.concatenate(parts) if parts else np.empty(0)
    speeds = speeds[np.isfinite(speeds)]
    if len(speeds) == 0:
        return None
    fast = float(np.percentile(speeds, 95.0))
    if fast < SLOWEST_M_S:
        return None
    low, middle, high = np.percentile(speeds[speeds > FLYING_SHARE * fast], [5.0, 50.0, 95.0])
    return float(low), float(middle), float(high)


def _mean_speed(maneuver: Maneuver) -> float:
    airspeed = maneuver.channels.get("airspeed")
    return float(np.mean(airspeed.y)) if airspeed is not None and len(airspeed) else float("nan")


def _median(parts: Sequence[FloatArray]) -> float | None:
    values = np.concatenate(parts) if parts else np.empty(0)
    values = values[np.isfinite(values) & (values > 0.0)]
    return float(np.median(values)) if len(values) else None
