"""Usability of a stream: missing or slow messages with remedies, and the service of the present data.

The necessary message rate depends on the aircraft. Before the first estimate, only a minimum rate can be
required. A 3-2-1-1 is matched to the short period, and its shortest step is about a third of the natural
period. With fewer than four samples in that step, the times of the step and of its response are uncertain.
The minimum is eight samples per second. A slow jet passes at 10 Hz, and the default rates of autopilots (2 to
4 Hz) fail. After an estimate, each manoeuvre is judged by its own natural frequency
(`advisor.decision.quality`).

A stream that was usable at the first manoeuvre may become too slow, or lose its elevator. Times of arrival
are used, because the vehicle's clock stops when ATTITUDE stops. Judgements happen at fixed steps of arrival,
so a log and a live link agree for any batches. The link's own watch reports a wholly silent link.
"""

from array import array
from collections.abc import Callable, Collection, Mapping, Sequence
from math import isfinite, nan

import numpy as np

from advisor.flight.elevator.elevator_guess import Guess
from advisor.flight.maneuvers.maneuver import DataAgain, NoData
from advisor.flight.signals.channels import READINGS
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.track import ChannelStatus
from advisor.flight.signals.trust import Distrust
from advisor.flight.vehicle.surfaces import Surface, joined_numbers, listed
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.process.arrays import FloatArray
from advisor.words.mends import GOOD_HZ, sentence
from advisor.words.problems import Problem
from advisor.words.quantities import distinct_texts

SLOWEST_HZ = 8.0
"""Least rate of elevator, pitch rate and angle of attack for any aircraft, Hz."""
_FIRST_BANK = 16
"""Last output number in the first SERVO_OUTPUT_RAW bank. Higher outputs may come in another message, or in
none."""
_MOTION = ("a_z", "airspeed", "theta")
"""Channels that replace an angle of attack, in addition to the pitch rate."""


def problems(
    vehicle: Vehicle | None,
    other_systems: Collection[int],
    elevator: Surface | Problem,
    channels: Mapping[str, ChannelStatus],
    maneuvers: int,
    activities: Mapping[str, int],
    still: Collection[Distrust] = (),
    seen: Collection[str] = (),
) -> list[Problem]:
    """Return every problem that prevents the use of a stream, the most fundamental first.

    Parameters
    ----------
    elevator
        Outputs of the elevator, or the reason why they are unknown.
    activities
        Number of elevator movements that were no test inputs, by the reason in words.
    """
    if vehicle is None:
        return [_no_vehicle(other_systems)]
    if vehicle.no_elevator is not None:
        obstacles = [vehicle.no_elevator]
    else:
        # A frozen angle of attack has a replacement: the one derived from climb rate and air speed.
        dead = {distrust.channel for distrust in still} & {"a_z"}
        alive = {name: status for name, status in channels.items() if name not in dead}
        obstacles = [
            *_missing(elevator, alive, vehicle, seen),
            *(Problem(d.code, f"{d.sentence}.", f"Fix: {d.fix}.") for d in still if d.stops),
            *_too_slow(alive, vehicle),
        ]
    if not obstacles and maneuvers == 0:
        obstacles.append(_no_maneuver(activities))
    if obstacles and other_systems:
        obstacles.insert(0, _perhaps_another(vehicle, other_systems))
    return obstacles


def with_guess(problem: Problem, guess: Guess) -> Problem:
    """Return the problem of an unknown elevator output with a guess added; any other problem is unchanged."""
    if problem.code != "no_elevator":
        return problem
    return Problem(problem.code, problem.text, f"{problem.fix.rstrip('.')}; {guess}.")


def _no_maneuver(activities: Mapping[str, int]) -> Problem:
    if not activities:
        return Problem(
            "no_maneuver",
            "No test manoeuvre was found, because the elevator did not move.",
            "Fly a 3-2-1-1 on the elevator in MANUAL. Hold the stick still for one second before and some "
            "seconds after.",
        )
    counted = "; ".join(f"{text} ({n} times)" if n > 1 else text for text, n in activities.items())
    return Problem(
        "no_maneuver",
        f"No test manoeuvre was found among the movements of the elevator: {counted}.",
        "Fly a 3-2-1-1 on the elevator in MANUAL, large enough to see in the pitch rate; "
        "analyze --all lists each movement.",
    )


def _perhaps_another(vehicle: Vehicle, other_systems: Collection[int]) -> Problem:
    others = ", ".join(str(n) for n in sorted(other_systems))
    return Problem(
        "other_vehicles",
        f"Vehicle {vehicle.system} was followed, which cannot be used; heard too: {others}.",
        f"Choose the vehicle that flew the manoeuvres, e.g. --target-system {min(other_systems)}.",
    )


def _no_vehicle(other_systems: Collection[int]) -> Problem:
    if other_systems:
        others = ", ".join(str(n) for n in sorted(other_systems))
        return Problem(
            "no_vehicle",
            f"The target system sent no heartbeat; heard were the vehicles {others}.",
            f"Choose one of them, e.g. --target-system {min(other_systems)}.",
        )
    return Problem(
        "no_vehicle",
        "No vehicle was heard: there is no HEARTBEAT of an autopilot.",
        "Check that the log or link comes from an aircraft, not only from a ground station.",
    )


def _missing(
    elevator: Surface | Problem,
    channels: Mapping[str, ChannelStatus],
    vehicle: Vehicle,
    seen: Collection[str],
) -> list[Problem]:
    mends = vehicle.mends
    if isinstance(elevator, Problem):
        obstacles, idle = [elevator], False
    else:
        idle = _is_without_pulse(elevator, channels, seen)
        obstacles = [_without_pulse(elevator, vehicle)] if idle else []
    if vehicle.carrier != "telemetry":
        return [*obstacles, *_not_logged(elevator, channels, vehicle, idle)]
    if "q" not in channels:
        # Its stamps are the vehicle's clock: without it no other channel can be placed either.
        text = f"There is no pitch rate: no {mends.called('ATTITUDE')} arrived."
        obstacles.append(Problem("no_pitch_rate", text, sentence(mends.faster("ATTITUDE"))))
        channels = _sent(seen)
    if isinstance(elevator, Surface) and "elevator" not in channels and not idle:
        outputs = joined_numbers(elevator.outputs)
        obstacles.append(
            Problem(
                "no_elevator",
                f"Servo output {outputs}, the elevator, never carried a pulse "
                f"({mends.called('SERVO_OUTPUT_RAW')}).",
                f"{sentence(mends.present(['SERVO_OUTPUT_RAW']), '')}, "
                "or set elevator.output in the aircraft file.",
            )
        )
    if "alpha" not in channels and not motion_stands_in(channels):
        absent = " nor ".join(name for name in _MOTION if name not in channels)
        or_else = ", or for AOA_SSA" if vehicle.autopilot == "ardupilot" else ""
        obstacles.append(
            Problem(
                "no_alpha",
                f"There is no angle of attack, and the motion cannot replace it: no {absent} arrived.",
                f"{sentence(mends.present(['RAW_IMU', 'VFR_HUD']), or_else)}; "
                f"a vane may send {mends.called('NAMED_VALUE_FLOAT')} (alpha.source).",
            )
        )
    return obstacles


def _is_without_pulse(
    elevator: Surface, channels: Mapping[str, ChannelStatus], seen: Collection[str]
) -> bool:
    """Return whether the servo output message arrives but never has a pulse for the elevator."""
    arrives = "q" in channels and "SERVO_OUTPUT_RAW" in seen
    return arrives and "elevator" not in channels and max(elevator.outputs) <= _FIRST_BANK


def _without_pulse(elevator: Surface, vehicle: Vehicle) -> Problem:
    outputs = joined_numbers(elevator.outputs)
    return Problem(
        "no_elevator",
        f"{vehicle.mends.called('SERVO_OUTPUT_RAW')} arrives, but output {outputs}, the elevator, carries no "
        "pulse: it is 0 throughout.",
        "Release the safety switch and arm the vehicle, or set elevator.output in the aircraft file.",
    )


def _sent(seen: Collection[str]) -> dict[str, ChannelStatus]:
    """Return the channels whose messages arrived, although none has a vehicle time."""
    sources = {reading.channel: reading.message for reading in READINGS if reading.message in seen}
    if not {"SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS"}.isdisjoint(seen):
        sources["elevator"] = "SERVO_OUTPUT_RAW"
    # The attitude comes with the pitch rate, which is requested anyway.
    sources["theta"] = "ATTITUDE"
    return {name: ChannelStatus(source, "", nan, nan, nan) for name, source in sources.items()}


def _not_logged(
    elevator: Surface | Problem, channels: Mapping[str, ChannelStatus], vehicle: Vehicle, idle: bool
) -> list[Problem]:
    """Return one problem that lists all missing messages. With ``idle``, another problem reports the missing
    pulse.
    """
    lacks: dict[str, tuple[str, str]] = {}
    if "q" not in channels:
        lacks["no_pitch_rate"] = ("pitch rate", "ATTITUDE")
    if isinstance(elevator, Surface) and "elevator" not in channels and not idle:
        lacks["no_elevator"] = (
            f"pulse of servo output {joined_numbers(elevator.outputs)}",
            "SERVO_OUTPUT_RAW",
        )
    if "alpha" not in channels and not motion_stands_in(channels):
        lacks["no_alpha"] = ("angle of attack", "AOA_SSA")
        if "airspeed" not in channels:
            lacks["no_airspeed"] = ("air speed", "VFR_HUD")
    if not lacks:
        return []
    if "a_z" not in channels:
        lacks["no_accelerometer"] = ("specific force", "HIGHRES_IMU")
    lacking = listed([f"no {what} ({vehicle.mends.called(message)})" for what, message in lacks.values()])
    fix = vehicle.mends.present([message for _, message in lacks.values()])
    given = "; or give airspeed_m_s in the aircraft file" if "no_airspeed" in lacks else ""
    return [Problem(next(iter(lacks)), f"The log holds {lacking}.", f"{sentence(fix, given)}.")]


def motion_stands_in(channels: Collection[str]) -> bool:
    """Return whether specific force, air speed and attitude replace an angle of attack."""
    return all(name in channels for name in _MOTION)


def _too_slow(channels: Mapping[str, ChannelStatus], vehicle: Vehicle) -> list[Problem]:
    if "q" not in channels:
        return []
    names = ("elevator", "q") if motion_stands_in(channels) else ("elevator", "q", "alpha")
    needed = [channels[name] for name in names if name in channels]
    slow = {_message(status): status.rate_hz for status in needed if not status.rate_hz >= SLOWEST_HZ}
    mends = vehicle.mends
    return [
        Problem(
            "rate",
            f"{mends.called(message)} arrives {_at(rate_hz)}, too slow to identify a short period "
            f"(at least {SLOWEST_HZ:g} Hz, better {GOOD_HZ} Hz).",
            sentence(mends.faster(message)),
        )
        for message, rate_hz in slow.items()
    ]


def _at(rate_hz: float) -> str:
    return f"at {distinct_texts(rate_hz, SLOWEST_HZ, 1)[0]} Hz" if isfinite(rate_hz) else "hardly at all"


def _message(status: ChannelStatus) -> str:
    """Return the name of the message that sets the rate of a channel."""
    return "VFR_HUD" if status.source.startswith("theta") else status.source.partition(".")[0]


WINDOW_S = 3.0
"""Length over which rates are counted, s: two dozen samples at the slowest allowed rate."""
STEP_S = 0.5
"""Time of arrival between two judgements, s."""
LAPSED_AFTER_S = 1.0
"""Time for which a problem must persist before its report, s. With ``WINDOW_S`` the report comes within 5
s."""
SERVED_AFTER_S = 5.0
"""Time without any problem before the problem's end is reported, s."""
PAUSE_S = 2.5
"""Silence of the vehicle after which counting restarts, s: two heartbeat intervals."""

Judge = Callable[[Mapping[str, ChannelStatus], float], Sequence[Problem]]


class Service:
    """Watch of the arriving messages, which reports when they become unusable and usable again.

    Parameters
    ----------
    judge
        Function that returns the problems of a stream with these recent channels, at a time of arrival, s.
    """

    def __init__(self, judge: Judge) -> None:
        self._judge = judge
        self._arrivals: dict[tuple[str, str], array[float]] = {}
        self._clock: list[tuple[float, float]] = []
        self._newest_s = -np.inf
        self._due_s = np.inf
        self._since_s: float | None = None
        self._standing: frozenset[str] = frozenset()
        self.problems: tuple[Problem, ...] = ()
        """Reasons why the stream cannot be used now; empty for a usable stream, or before the first
        judgement.
        """
        self.serves = False
        """Whether the newest judgement found no problem, and no problem is reported. False before the first
        judgement."""

    def begin(self) -> None:
        """Begin another vehicle or another power-on, and forget the earlier messages."""
        self._arrivals.clear()
        self._clock.clear()
        self._newest_s = -np.inf

    def end(self) -> None:
        """End the watch, because no further message comes or is wanted."""
        self.problems = ()

    def take(self, channel: str, source: str, arrival_s: FloatArray) -> None:
        """Take the times of arrival, shape (n,), of a channel's samples from one source."""
        times = self._arrivals.setdefault((channel, source), array("d"))
        times.frombytes(np.asarray(arrival_s, float).tobytes())

    def take_clock(self, arrival_s: FloatArray, vehicle_s: FloatArray) -> None:
        """Take the vehicle's clock, s since boot, at times of arrival, s; both of shape (n,)."""
        self._clock.extend(zip(arrival_s.tolist(), vehicle_s.tolist(), strict=True))

    def advance(self, columns: Sequence[Columns]) -> list[NoData | DataAgain]:
        """Judge the stream at every step of arrival that these messages have passed."""
        if not columns:
            return []
        newest_s = max(float(c.arrival_s[-1]) for c in columns)
        if newest_s < min(self._due_s, self._newest_s + PAUSE_S):
            # As nearly always: no moment of judgement has passed.
            self._newest_s = max(self._newest_s, newest_s)
            return []
        news: list[NoData | DataAgain] = []
        for now_s in np.unique(np.concatenate([c.arrival_s for c in columns])).tolist():
            if now_s > self._newest_s + PAUSE_S:
                self._due_s = now_s + WINDOW_S
                self._since_s = None
            while self._due_s <= now_s:
                news += self._look(self._due_s)
                self._due_s += STEP_S
            self._newest_s = max(self._newest_s, now_s)
        self._forget()
        return news

    def _forget(self) -> None:
        """Drop times of arrival that no later judgement needs."""
        oldest_s = self._newest_s - WINDOW_S - STEP_S
        for times in self._arrivals.values():
            needed = np.flatnonzero(np.array(times) > oldest_s)
            del times[: int(needed[0]) if len(needed) else len(times)]
        # The newest reading stays, however long ago the clock stopped.
        del self._clock[: sum(arrival_s <= oldest_s for arrival_s, _ in self._clock[:-1])]

    def _look(self, now_s: float) -> list[NoData | DataAgain]:
        problems = tuple(self._judge(self._lately(now_s), now_s))
        standing = frozenset(problem.code for problem in problems)
        if standing != self._standing or self._since_s is None:
            self._standing, self._since_s = standing, now_s
        stood_s = now_s - self._since_s
        reported = {problem.code for problem in self.problems}
        self.serves = not problems and not reported
        if reported and not problems and stood_s >= SERVED_AFTER_S:
            self.problems, self.serves = (), True
            return [DataAgain(self._vehicle_s(now_s))]
        if standing == reported or not problems or stood_s < LAPSED_AFTER_S:
            return []
        self.problems = problems
        return [] if standing < reported else [NoData(problems, self._vehicle_s(now_s))]

    def _vehicle_s(self, now_s: float) -> float:
        """Return the vehicle's clock at a time of arrival, s; NaN before its first reading."""
        return max((t for arrival_s, t in self._clock if arrival_s <= now_s), default=nan)

    def _lately(self, now_s: float) -> dict[str, ChannelStatus]:
        """Return the arrival status of every channel within the window, from its fastest source."""
        statuses: dict[str, ChannelStatus] = {}
        for (channel, source), times in self._arrivals.items():
            heard = np.array(times)
            newest = heard[(heard > now_s - WINDOW_S) & (heard <= now_s)]
            rate_hz = len(newest) / WINDOW_S
            if len(newest) and (channel not in statuses or rate_hz > statuses[channel].rate_hz):
                statuses[channel] = ChannelStatus(source, "", rate_hz, WINDOW_S, float(newest[-1]))
        return statuses
