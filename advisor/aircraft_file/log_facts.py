"""Facts of a log about its aircraft (outputs and their limits, air speed, pressure, angle of attack), and
what they leave open.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.key import keys_of
from advisor.flight.elevator.elevator_guess import Guess
from advisor.flight.elevator.elevator_outputs import SIDES, find_side_control
from advisor.flight.maneuvers.maneuver import Maneuver, ManeuverFlown
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.trust import InstrumentFinding
from advisor.flight.stream.stream import FlightStream
from advisor.flight.vehicle.parameters import Parameters
from advisor.flight.vehicle.surfaces import Scale, Surface, Wiring
from advisor.flight.vehicle.vehicle import Vehicle
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


KEYS = tuple(key for key in keys_of(Aircraft) if key.example)
"""Keys that a new aircraft file contains."""


BEYOND_US = 20.0
"""Largest excess of pulses over a calibration without a warning, us. The trims of servo and transmitter
differ by about this much.
"""


@dataclass(frozen=True, slots=True)
class Lack:
    """One key of an aircraft file that is missing, or that contradicts the log."""

    key: str
    """Path of the key in the aircraft file."""
    cost: str
    """Sentence on the cost of the missing key."""
    mend: str
    """Clause on the remedy in the aircraft file."""
    wrong: bool = False
    """Whether the key exists and contradicts the log."""


def lacks_of(aircraft: Aircraft, facts: LogFacts | None = None) -> tuple[Lack, ...]:
    """Return the keys that contradict the log, then the missing keys in the order of the file.

    Parameters
    ----------
    facts
        Facts of a log of this aircraft. None: the file is checked without a log.
    """
    lacks = [
        Lack(key.path, key.cost, key.mend)
        for key in KEYS
        if key.cost and _counts(key.path, aircraft, facts) and not _given(key.path, aircraft)
    ]
    return (*(_contradictions(aircraft, facts) if facts else ()), *lacks)


def _given(path: str, aircraft: Aircraft) -> bool:
    """Return whether the aircraft file has the key, or another key that replaces it."""
    match path:
        case "elevator.output":
            return aircraft.elevator.output != "auto" or bool(aircraft.elevator.outputs)
        case "aileron.output":
            return aircraft.aileron.output != "auto"
        case "rudder.output":
            return aircraft.rudder.output != "auto"
        case "elevator.calibration":
            return aircraft.elevator.is_calibrated
        case "model":
            return bool(aircraft.model) or aircraft.simulator is not None
    return attrgetter(path)(aircraft) is not None


def _counts(path: str, aircraft: Aircraft, facts: LogFacts | None) -> bool:
    """Return whether a missing key costs anything on this aircraft."""
    section, _, _ = path.partition(".")
    if section in SIDES and facts is not None and facts.wiring.roles and section not in facts.sides:
        # An aircraft whose parameters name other surfaces may have no rudder.
        return False
    match path:
        case "elevator.output":
            return facts is None or not isinstance(facts.elevator, Surface)
        case "aileron.output" | "rudder.output":
            return facts is None or section not in facts.sides
        case "airspeed_m_s":
            return facts is not None and facts.airspeed_m_s is None
        case "alpha.vane_arm_m":
            stated = aircraft.alpha.source.startswith("named_value:")
            return stated or (facts is not None and facts.alpha_provenance == "vane")
    return True


def _contradictions(aircraft: Aircraft, facts: LogFacts) -> Iterator[Lack]:
    if not isinstance(facts.elevator, Surface):
        yield Lack("elevator.output", facts.elevator.text, facts.elevator.fix.rstrip("."), wrong=True)
    yield from _beyond_calibration(aircraft, facts)
    wanted = aircraft.alpha.source
    if wanted not in ("auto", "none") and facts.alpha_source is None:
        yield Lack(
            "alpha.source",
            f"The log has no angle of attack by {wanted}.",
            "record the source that alpha.source names, or write alpha.source: auto",
            wrong=True,
        )
    reference = aircraft.reference_airspeed_m_s
    if reference is not None and facts.airspeed_m_s is not None:
        low, _, high = facts.airspeed_m_s
        if not low <= reference <= high:
            yield Lack(
                "reference_airspeed_m_s",
                f"The derivatives are carried over to {reference:g} m/s; the log was flown at "
                f"{low:.1f} to {high:.1f} m/s.",
                "write an air speed within the range that was flown",
                wrong=True,
            )


def _beyond_calibration(aircraft: Aircraft, facts: LogFacts) -> Iterator[Lack]:
    """Yield the outputs whose pulses exceed their calibration, beyond which the deflection is constant."""
    calibrations = {output.output: output.calibration for output in aircraft.elevator.outputs}
    if aircraft.elevator.calibration and len(facts.outputs) == 1:
        calibrations = {facts.outputs[0]: aircraft.elevator.calibration}
    for output, pairs in calibrations.items():
        if pairs is None or output not in facts.pulses_us:
            continue
        low, high = facts.pulses_us[output]
        first, last = min(pwm for pwm, _ in pairs), max(pwm for pwm, _ in pairs)
        if low < first - BEYOND_US or high > last + BEYOND_US:
            yield Lack(
                "elevator.calibration",
                f"Output {output} moves from {low:.0f} to {high:.0f} us in the log, the calibration ends at "
                f"{first:.0f} and {last:.0f} us: outside, the deflection is constant.",
                "measure the deflection at the pulses that were flown",
                wrong=True,
            )


_OF_QUANTITY: Mapping[str, str] = {"sign": "calibration", "scale": "calibration", "unit": "source"}
"""Key of the aircraft file that states a property of an instrument, by the property's name."""


def contradicted(findings: Iterable[InstrumentFinding]) -> list[Lack]:
    """Return the keys that the motion of a log contradicts, with the sentences of the analysis."""
    return [
        Lack(
            f"{finding.channel}.{_OF_QUANTITY.get(finding.quantity, finding.quantity)}",
            f"{finding.sentence}.",
            finding.fix or "see the sentence above",
            wrong=True,
        )
        for finding in findings
        if finding.contradicts
    ]


def known_keys(aircraft: Aircraft) -> list[str]:
    """Return the paths of the keys that a file has, among all keys whose absence has a cost."""
    return [key.path for key in KEYS if key.cost and _given(key.path, aircraft)]
