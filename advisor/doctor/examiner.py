"""Examination of telemetry. It turns messages into findings, and neither reads files nor prints."""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.log_facts import FLYING_SHARE, SLOWEST_M_S
from advisor.campaign.single_maneuver import together
from advisor.decision.first_unit import frequency
from advisor.doctor.examination import AlphaFound, ElevatorFound, Examination, Limit, in_order
from advisor.doctor.expectation import Assumed, assumed_of, at_log_rates, expect
from advisor.doctor.limits import (
    Paced,
    alpha_limits,
    clock_limits,
    clock_notes,
    company_limits,
    cost_of_missing,
    distrust_limits,
    elevator_limits,
    loss_limits,
    path_limits,
    rate_limits,
    repeat_limits,
    sender_limits,
    steadiness_limits,
)
from advisor.doctor.survey import Arrival, Survey, bank_name
from advisor.flight.maneuvers.maneuver import READER_NOTICE, Maneuver, ManeuverFlown, Notice
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.track import ChannelStatus
from advisor.flight.stream.stream import FlightStream
from advisor.flight.stream.suitability import problems
from advisor.flight.stream.surfaces_heard import speakers
from advisor.flight.vehicle.parameters import Parameters
from advisor.flight.vehicle.surfaces import Surface
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.problems import Problem

LEAST_HEAP = 65_536
"""Least SCR_HEAP_SIZE, bytes. Least value of SCR_HEAP_SIZE, bytes, for a script of all inputs. The script
takes 86 kB in an interpreter of 64 bits. Most values take half of this on a board of 32 bits; the rest is
reserve between two garbage collections.
"""
_PREFIX = "SCR_"
_FUNCTION = "SERVO{}_FUNCTION"


class ScriptParameters:
    """Parameters of the scripting engine and functions of the outputs, as far as they are stated."""

    def __init__(self) -> None:
        self._parameters = Parameters(lambda name: name.startswith((_PREFIX, "SERVO")))

    def feed(self, columns: Sequence[Columns]) -> None:
        for part in columns:
            if part.name == "PARAM_VALUE":
                for name, _, stated in self._parameters.news(part):
                    self._parameters.keep((part.system, part.component), name, stated)

    def notes(self, vehicle: Vehicle | None, elevator: object) -> list[str]:
        """Return a sentence with its remedy for each obstacle to a script on an ArduPilot vehicle."""
        if vehicle is None or vehicle.autopilot != "ardupilot":
            return []
        return script_notes(self._parameters.stated(speakers(vehicle), vehicle.autopilot), elevator)


def script_notes(stated: Mapping[str, float], elevator: object) -> list[str]:
    """Return a sentence for each parameter whose value prevents the vehicle from flying a script.

    Parameters
    ----------
    stated
        Values of SCR_ENABLE, SCR_HEAP_SIZE and SERVOn_FUNCTION, by name, as far as they are known.
    elevator
        Elevator of the vehicle, whose outputs the script moves.
    """
    notes = []
    if stated.get(f"{_PREFIX}ENABLE") == 0.0:
        notes.append("SCR_ENABLE is 0, so the vehicle flies no script: set SCR_ENABLE 1 and restart it.")
    heap = stated.get(f"{_PREFIX}HEAP_SIZE")
    if heap is not None and heap < LEAST_HEAP:
        notes.append(
            f"SCR_HEAP_SIZE is {heap:.0f} (a script of all inputs needs {LEAST_HEAP}): "
            "set SCR_HEAP_SIZE 100000 and restart the vehicle."
        )
    outputs = elevator.outputs if isinstance(elevator, Surface) else ()
    notes += [
        f"{_FUNCTION.format(n)} is 0, so no script moves output {n}: set it to the surface's function."
        for n in outputs
        if stated.get(_FUNCTION.format(n)) == 0.0
    ]
    return notes


_DERIVED_RENEWAL_HZ = 20.0  # ArduPilot refreshes AOA_SSA no faster; on the ground its value stands still


class Examiner:
    """Collects the messages of a log or link, then returns the findings.

    Parameters
    ----------
    target_system
        System id of the vehicle; None for the first vehicle that sends.
    """

    def __init__(self, aircraft: Aircraft, target_system: int | None = None) -> None:
        self._aircraft = aircraft
        self._chosen = target_system is not None
        self._stream = FlightStream(aircraft, target_system)
        self._survey: Survey | None = None
        self._surveyed_system: int | None = None
        self._maneuvers: list[Maneuver] = []
        self._notes: list[str] = []
        self._script = ScriptParameters()

    def feed(self, columns: Sequence[Columns]) -> None:
        """Process the next messages."""
        self._keep(self._stream.feed(columns))
        self._script.feed(columns)
        vehicle = self._stream.vehicle
        if vehicle is not None and vehicle.system != self._surveyed_system:
            self._survey, self._surveyed_system = Survey(vehicle), vehicle.system
        if self._survey is not None:
            self._survey.feed(columns)

    @property
    def vehicle(self) -> Vehicle | None:
        """Vehicle whose telemetry is examined. None before its first heartbeat."""
        return self._stream.vehicle

    def findings(
        self,
        lost_percent: float | None = None,
        repeated_percent: float = 0.0,
        repeated_after_s: float = np.nan,
    ) -> Examination:
        """Return the findings of the examination. The caller calls this method once, at the end.

        Parameters
        ----------
        lost_percent
            Fraction of packets lost; None if no live link counted them.
        repeated_percent, repeated_after_s
            Fraction of the vehicle's packets that came twice, and the delay of the second copy.
        """
        self._keep(self._stream.finish())
        vehicle = self._stream.vehicle
        assumed = assumed_of(self._maneuvers, self._aircraft)
        arrivals = {arrival.name: arrival for arrival in self._survey.arrivals} if self._survey else {}
        clocks = self._survey.clocks if self._survey else None
        paced = self._paced(arrivals)
        channels = {
            name: status
            for name, status in self._stream.channels.items()
            if name in paced or name != "elevator"
        }
        still = self._stream.frozen
        stops = problems(
            vehicle,
            self._stream.other_systems,
            self._stream.elevator,
            channels,
            1,
            {},
            still,
            self._stream.seen,
        )
        speed = self._airspeed(paced)
        complete = {"elevator", "q"} <= paced.keys() and (
            "alpha" in paced or ("a_z" in paced and speed is not None)
        )
        rates = {name: channel.renewed_hz for name, channel in paced.items()}
        assumed = at_log_rates(assumed, rates, speed) if complete else assumed
        # Rates are compared with the aircraft's own pace where it is known; else with the least for any
        # aircraft.
        limits = [_stopping(problem, vehicle) for problem in stops if problem.code != "rate" or not complete]
        limits += distrust_limits([*still, *(d for m in self._maneuvers for d in m.distrusts)])
        instruments = together(self._maneuvers, self._stream.instruments)
        texts = {limit.text for limit in limits}
        limits += [
            Limit(f.code, f.sentence, f.fix, stops=f.refuses) for f in instruments if f.sentence not in texts
        ]
        if vehicle is not None and complete:
            limits += rate_limits(paced, assumed, vehicle, speed)
        period_s = 2.0 * np.pi / frequency(assumed.model)
        carrier = vehicle.carrier if vehicle else "telemetry"
        paced_by = {self._surveyed(p.message) for p in paced.values()}
        limits += steadiness_limits(arrivals, paced_by, period_s, carrier)
        if vehicle is not None and complete:
            limits += self._speed_limits(paced, assumed, vehicle, speed)
            limits += alpha_limits(self._stream.channels["alpha"], vehicle) if "alpha" in paced else []
        elevator = self._elevator()
        limits += elevator_limits(elevator, self._aircraft.elevator) if elevator else []
        limits += repeat_limits(arrivals.values())
        limits += clock_limits(clocks) if clocks else []
        limits += sender_limits(self._stream.senders.seen)
        limits += company_limits(self._stream.other_systems) if not self._chosen else []
        limits += loss_limits(lost_percent)
        limits += path_limits(repeated_percent, repeated_after_s)
        return Examination(
            vehicle=vehicle,
            messages=tuple(arrivals.values()),
            clocks=clocks,
            elevator=elevator,
            alpha=self._alpha(paced),
            limits=in_order(limits),
            expectation=expect(assumed, rates, speed) if complete else None,
            assumed=assumed,
            instruments=instruments,
            airspeed_m_s=self._flown_at(),
            notes=(
                *self._notes,
                *([str(unknown)] if (unknown := self._stream.sides_unknown) else ()),
                *dict.fromkeys(note for m in self._maneuvers for note in m.data_notes),
                *self._script.notes(vehicle, self._stream.elevator),
                *(self._survey.pauses if self._survey else ()),
                *(clock_notes(clocks) if clocks else ()),
            ),
        )

    def _keep(self, events: Sequence[object]) -> None:
        self._maneuvers += [event.maneuver for event in events if isinstance(event, ManeuverFlown)]
        self._notes += [e.text for e in events if isinstance(e, Notice) and e.code == READER_NOTICE]

    def _paced(self, arrivals: dict[str, Arrival]) -> dict[str, Paced]:
        """Return the channels that identification needs, with the messages that determine their rates."""
        paced = {}
        dead = {distrust.channel for distrust in self._stream.frozen} - {"alpha"}  # another may be derived
        for name in ("elevator", "q", "alpha", "a_z"):
            status = self._stream.channels.get(name)
            if status is None or name in dead or not status.rate_hz > 0.0:
                continue
            message = _message(status, arrivals)
            arrival = arrivals.get(self._surveyed(message))
            if arrival is None:
                continue
            rate_hz = float(np.fmin(status.rate_hz, arrival.rate_hz))
            renewed_hz = rate_hz
            if name == "alpha":
                renewed_hz = min(renewed_hz, _renewal(arrival, status))
            paced[name] = Paced(name, message, rate_hz, renewed_hz, status.rate_hz)
        return paced

    def _surveyed(self, message: str) -> str:
        """Return a message's name in the survey. For SERVO_OUTPUT_RAW this is the last bank of outputs, which
        completes a sample of the elevator.
        """
        elevator = self._stream.elevator
        if message != "SERVO_OUTPUT_RAW" or not isinstance(elevator, Surface):
            return message
        return bank_name(elevator.ports[-1])

    def _airspeed(self, paced: dict[str, Paced]) -> float | None:
        """Return the air speed with which a_z is computed; None if no air speed is measured or given."""
        if self._aircraft.airspeed_m_s is not None:
            return self._aircraft.airspeed_m_s
        recent = self._stream.tracks.recent("airspeed", 60.0)
        if recent is None or len(recent) == 0:
            return None
        return max(10.0, float(np.median(recent.y)))  # on the ground: a speed to fly at

    def _flown_at(self) -> tuple[float, float] | None:
        """Return the lowest and highest air speed in flight; None without an air speed."""
        course = self._stream.tracks.courses().get("airspeed")
        if course is None or not len(course.high):
            return None
        most = float(np.percentile(course.high, 95.0))
        flying = course.low > FLYING_SHARE * most
        if most < SLOWEST_M_S or not flying.any():
            return None
        return float(np.min(course.low[flying])), float(np.max(course.high[flying]))

    def _elevator(self) -> ElevatorFound | None:
        elevator = self._stream.elevator
        if not isinstance(elevator, Surface):
            return None
        # Each output moves alone: the halves of a mixed pair may count in opposite directions.
        pulses = np.repeat(np.arange(800.0, 2201.0)[:, None], len(elevator.parts), axis=1)
        steps = np.degrees(np.max(np.abs(np.diff(elevator.angles(pulses), axis=0)), axis=0))
        coarsest = max(part.share * float(step) for part, step in zip(elevator.parts, steps, strict=True))
        return ElevatorFound(elevator.outputs, coarsest, elevator.calibrated, elevator.doubts)

    def _alpha(self, paced: dict[str, Paced]) -> AlphaFound | None:
        status = self._stream.channels.get("alpha")
        if status is None or "alpha" not in paced:
            return None
        source = status.source.removesuffix(".AOA")
        return AlphaFound(source, status.provenance, paced["alpha"].renewed_hz)

    def _speed_limits(
        self, paced: dict[str, Paced], assumed: Assumed, vehicle: Vehicle, speed: float | None
    ) -> list[Limit]:
        """Return the limits from a missing air speed or specific force, which increase some errors."""
        if speed is None:
            text = "No air speed arrives: derivatives have no common speed, and a_z cannot be used"
            fix = _fast("VFR_HUD", vehicle) + "; or give airspeed_m_s in the aircraft file"
            cost = cost_of_missing("a_z", paced, assumed, None)
            return [Limit("no_airspeed", text, fix, std_ratio=cost)]
        if "a_z" not in paced and "a_z" not in self._stream.channels:
            any_of = "RAW_IMU, SCALED_IMU, SCALED_IMU2, SCALED_IMU3 or HIGHRES_IMU"
            named = any_of if vehicle.carrier == "telemetry" else vehicle.mends.called("RAW_IMU")
            text = f"No specific force arrives ({named})"
            fix = _fast("RAW_IMU", vehicle)
            cost = cost_of_missing("a_z", paced, assumed, speed)
            return [Limit("no_accelerometer", text, fix, std_ratio=cost)]
        return []


def _fast(message: str, vehicle: Vehicle) -> str:
    """Return the remedy for a missing message: how to request it at a good rate."""
    if vehicle.carrier == "telemetry":
        return vehicle.mends.faster(message)
    return vehicle.mends.present([message])


def _stopping(problem: Problem, vehicle: Vehicle | None) -> Limit:
    fix = problem.fix.removeprefix("Fix: ").rstrip(".")
    if problem.code == "no_elevator" and (vehicle is None or vehicle.carrier == "telemetry"):
        fix += "; on a live link --request-rates asks the vehicle for them"
    return Limit(problem.code, problem.text.rstrip("."), f"{fix[:1].lower()}{fix[1:]}", stops=True)


def _message(status: ChannelStatus, arrivals: Mapping[str, Arrival]) -> str:
    """Return the message that determines the rate of a channel. For a derived channel this is the slower of
    two messages.
    """
    if not status.source.startswith("theta"):
        return status.source.partition(".")[0]
    both = [arrivals[name] for name in ("VFR_HUD", "ATTITUDE") if name in arrivals]
    return min(both, key=lambda arrival: arrival.rate_hz).name if both else "VFR_HUD"


def _renewal(arrival: Arrival, status: ChannelStatus) -> float:
    if np.isfinite(arrival.renewed_hz):
        return arrival.renewed_hz
    return _DERIVED_RENEWAL_HZ if status.provenance == "derived" else arrival.rate_hz
