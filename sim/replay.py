"""Replay of recorded elevator commands through another aircraft."""

from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arrays import FloatArray
from .autopilot import CRUISE, MANUAL, Autopilot, Demand, Planned
from .loading import ScenarioError
from .motion import Motion
from .servo import Calibration
from .tlog import read_tlog

ELEVATOR_FUNCTION = 19
THROTTLE_FUNCTION = 70
AUTOPILOT_INVALID = 8
"""Value of HEARTBEAT.autopilot that ground stations send."""


@dataclass(frozen=True)
class Recording:
    """Elevator command, mode and airspeed from a log. Times are vehicle times, s since boot."""

    time_s: FloatArray
    pulse_us: FloatArray
    throttle: FloatArray
    """Throttle at ``time_s``, 0..1."""
    mode_time_s: FloatArray
    mode: NDArray[np.int64]
    airspeed_time_s: FloatArray
    airspeed_m_s: FloatArray
    calibration: Calibration
    """Calibration from the log's SERVOn_* parameters, with ±25 deg at the ends."""
    unix_s: float
    """Host time of the first command, s since 1970."""

    @property
    def begins_s(self) -> float:
        """Begin of the first MANUAL stretch, s after the first command."""
        flown = self.mode_time_s[self.mode == MANUAL]
        return max(float(flown[0] - self.time_s[0]), 0.0) if len(flown) else 0.0

    def manual(self, time_s: float) -> bool:
        """Return whether ``time_s`` (since boot) lies in a MANUAL stretch. A log without MANUAL is taken as
        manual throughout."""
        if not (self.mode == MANUAL).any():
            return True
        index = int(np.searchsorted(self.mode_time_s, time_s, side="right")) - 1
        return bool(self.mode[max(index, 0)] == MANUAL)


def read_recording(path: Path, output: int | None = None) -> Recording:
    """Return the recording in a tlog. ``output`` is the elevator's servo output. None for the output with
    function 19.

    Raises
    ------
    ScenarioError
        The log cannot be read, or contains no elevator command.
    """
    found: dict[str, list[tuple[float, Any]]] = defaultdict(list)
    try:
        for host_s, message in read_tlog(path, ("SERVO_OUTPUT_RAW", "HEARTBEAT", "VFR_HUD", "PARAM_VALUE")):
            if getattr(message, "autopilot", 0) != AUTOPILOT_INVALID:
                found[message.get_type()].append((host_s, message))
    except OSError as error:
        raise ScenarioError([f"{path}: cannot be read ({error.strerror})"]) from error
    commands = [(host_s, message) for host_s, message in found["SERVO_OUTPUT_RAW"] if message.port == 0]
    if len(commands) < 2:
        raise ScenarioError([f"{path}: this log has no SERVO_OUTPUT_RAW, so no command can be flown again"])
    parameters = {message.param_id: message.param_value for _, message in found["PARAM_VALUE"]}
    output = output or _output(parameters, ELEVATOR_FUNCTION, 2)
    throttle = _output(parameters, THROTTLE_FUNCTION, 3)
    stamps = np.array([message.time_usec for _, message in commands], dtype=np.int64)
    wraps = np.cumsum(np.diff(stamps, prepend=stamps[0]) < -(2**31))
    time_s = (stamps + wraps * 2**32) / 1e6
    host = np.array([host_s for host_s, _ in commands])
    keep = np.concatenate([[True], np.diff(np.maximum.accumulate(time_s)) > 0])
    time_s, host = time_s[keep], host[keep]
    pulses = np.array([getattr(message, f"servo{output}_raw") for _, message in commands], dtype=float)[keep]
    opened = np.array([getattr(message, f"servo{throttle}_raw") for _, message in commands], dtype=float)[
        keep
    ]

    def at(messages: list[tuple[float, Any]]) -> FloatArray:
        return np.asarray(np.interp([host_s for host_s, _ in messages], host, time_s))

    return Recording(
        time_s,
        pulses,
        np.clip((opened - 1100.0) / 800.0, 0.0, 1.0),
        at(found["HEARTBEAT"]),
        np.array([message.custom_mode for _, message in found["HEARTBEAT"]], dtype=np.int64),
        at(found["VFR_HUD"]),
        np.array([message.airspeed for _, message in found["VFR_HUD"]]),
        _calibration(parameters, output),
        float(host[0]),
    )


def _output(parameters: dict[str, float], function: int, otherwise: int) -> int:
    for output in range(1, 17):
        if parameters.get(f"SERVO{output}_FUNCTION") == function:
            return output
    return otherwise


def _calibration(parameters: dict[str, float], output: int) -> Calibration:
    low, trim, high = (
        float(parameters.get(f"SERVO{output}_{end}", usual))
        for end, usual in (("MIN", 1100.0), ("TRIM", 1500.0), ("MAX", 1900.0))
    )
    # ArduPilot's elevator pulls with more pulse width, unless reversed.
    pull = -25.0 if parameters.get(f"SERVO{output}_REVERSED", 0.0) else 25.0
    return Calibration(((low, pull), (trim, 0.0), (high, -pull)))


class RecordedPilot:
    """Pilot who replays a recording in its MANUAL stretches. Between these stretches the autopilot holds the
    attitude.

    Attitude and height are integrals, so a slightly different aircraft would drift away without the hold.
    """

    def __init__(self, recording: Recording, calibration: Calibration, autopilot: Autopilot) -> None:
        self._recording = recording
        self._calibration = calibration
        self._autopilot = autopilot
        self._begin_s = float(recording.time_s[0])

    def demand(self, time_s: float, motion: Motion, period_s: float) -> Demand:
        """Return the recorded command at ``time_s``. Between manoeuvres return the autopilot's command."""
        boot_s = self._begin_s + time_s
        held = self._autopilot.demand(time_s, motion, period_s)
        throttle = float(np.interp(boot_s, self._recording.time_s, self._recording.throttle))
        if not self._recording.manual(boot_s):
            return held._replace(throttle=throttle)
        pulse = round(float(np.interp(boot_s, self._recording.time_s, self._recording.pulse_us)))
        elevator = self._calibration.deflection(pulse)
        return Demand(elevator, throttle, held.aileron, 0.0, MANUAL, 0.0)

    def current(self, time_s: float) -> Planned | None:
        """Return None, because a recording has no plan."""
        return None

    def mode(self, time_s: float) -> int:
        """Return the flight mode at ``time_s``."""
        return MANUAL if self._recording.manual(self._begin_s + time_s) else CRUISE


class RecordedAirspeed:
    """Recorded airspeed for the linear aircraft, smoothed over half a second."""

    def __init__(self, recording: Recording) -> None:
        self._time = recording.airspeed_time_s
        self._begin_s = float(recording.time_s[0])
        count = max(1, round(0.5 / max(float(np.median(np.diff(self._time))), 1e-3)))
        padded = np.pad(recording.airspeed_m_s, count, mode="edge")
        self._speed = np.convolve(padded, np.ones(count) / count, mode="same")[count:-count]

    def apply(self, time_s: float, motion: Motion, engine: Any) -> None:
        """Set the engine's airspeed for ``time_s``."""
        now = self._begin_s + time_s
        before, after = np.interp([now - 0.05, now + 0.05], self._time, self._speed)
        engine.airspeed = float(np.interp(now, self._time, self._speed))
        engine.airspeed_dot = float(after - before) / 0.1
