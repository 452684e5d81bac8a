"""MAVLink 2 messages of the bundled aircraft, similar to those of ArduPlane."""

import math
from collections.abc import Iterator
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from .airframe import GRAVITY_M_S2
from .autopilot import MANUAL
from .flight import Sample
from .motion import HOME_HEIGHT_M
from .parameters import STREAM_GROUPS, STREAM_OF_ID, parameter_table, parameter_type
from .scenario import Clock
from .servo import Calibration

SYSTEM, COMPONENT = 1, 1
HOME_LATITUDE, HOME_LONGITUDE = 47.0, 11.0
METRES_PER_DEGREE = 111_319.5

VERSION = (4, 5, 6)
"""ArduPlane version that the messages imitate."""

ARMED_MANUAL = int(
    mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    | mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
    | mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
)
ARMED_CRUISE = int(ARMED_MANUAL | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED)

PARAMETERS_PER_TICK = 10

SWITCH_ON_US, SWITCH_OFF_US = 1900, 1100
"""Pulses of the pilot's switch, us. The switch is on in MANUAL."""

Message = Any
"""A pymavlink message; the package carries no types."""


class Voice:
    """Source of due messages from samples, and of replies to requests.

    Requested rates beyond the loop's rate are limited to it, as on the real autopilot. Servo outputs are
    written and stamped ``output_late_s`` after the tick.
    """

    def __init__(
        self, rates: dict[str, float], clock: Clock, calibration: Calibration, output_late_s: float = 0.0
    ) -> None:
        self._output_late_s = output_late_s
        self._clock = clock
        self._calibration = calibration
        self._interval = {name: 1.0 / rate if rate > 0 else math.inf for name, rate in rates.items()}
        self._due = dict.fromkeys(rates, 0.0)
        self.parameters = parameter_table(rates, SYSTEM, calibration)
        self._queue: list[str] = []
        self._texts: list[tuple[int, str]] = []

    def say(self, text: str, severity: int = 6) -> None:
        """Queue a text as STATUSTEXT for the next tick."""
        self._texts.append((severity, text))

    def send_parameters(self) -> None:
        """Queue every parameter, as after PARAM_REQUEST_LIST."""
        self._queue = list(self.parameters)

    def speak(self, sample: Sample, stamp_error_s: float = 0.0) -> Iterator[Message]:
        """Yield the messages due at this sample, in ArduPilot's order."""
        now = sample.time_s
        boot_s = self._clock.boot_s + now + stamp_error_s
        for severity, text in self._texts:
            yield mavlink.MAVLink_statustext_message(severity, text.encode()[:50], 0, 0)
        self._texts.clear()
        for name in self._queue[:PARAMETERS_PER_TICK]:
            yield self._parameter(name)
        del self._queue[:PARAMETERS_PER_TICK]
        for name, due in self._due.items():
            if now < due - 1e-6:
                continue
            interval = self._interval[name]
            # A stream that fell behind restarts, instead of catching up in a burst.
            self._due[name] = due + interval if now < due + interval - 1e-6 else now + interval
            if interval != math.inf:
                yield getattr(self, f"_{name.lower()}")(sample, boot_s)

    def hear(self, message: Message) -> list[Message]:
        """Act on a message from outside, and return the replies."""
        kind = message.get_type()
        if getattr(message, "target_system", SYSTEM) not in (0, SYSTEM):
            return []
        if kind == "PARAM_REQUEST_LIST":
            self.send_parameters()
        elif kind == "PARAM_REQUEST_READ":
            return self._parameter_asked(message)
        elif kind == "PARAM_SET":
            return self._set_parameter(message)
        elif kind == "REQUEST_DATA_STREAM":
            group = STREAM_OF_ID.get(message.req_stream_id)
            rate = message.req_message_rate if message.start_stop else 0
            for name in STREAM_GROUPS:
                if message.req_stream_id == 0 or name == group:
                    self._set_group(name, rate)
        elif kind == "COMMAND_LONG":
            return self._command(message)
        return []

    def _command(self, message: Message) -> list[Message]:
        result, extra = mavlink.MAV_RESULT_UNSUPPORTED, []
        if message.command == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            name = _name_of(int(message.param1))
            if name in self._interval:
                self._set_interval(name, message.param2)
                result = mavlink.MAV_RESULT_ACCEPTED
            else:
                result = mavlink.MAV_RESULT_DENIED
        elif message.command == mavlink.MAV_CMD_GET_MESSAGE_INTERVAL:
            name = _name_of(int(message.param1))
            if name in self._interval:
                interval = self._interval[name]
                shown = -1 if interval == math.inf else round(1e6 * interval)
                extra = [mavlink.MAVLink_message_interval_message(int(message.param1), shown)]
                result = mavlink.MAV_RESULT_ACCEPTED
        elif message.command in (
            mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES,
            mavlink.MAV_CMD_REQUEST_MESSAGE,
        ):
            version = (
                message.command != mavlink.MAV_CMD_REQUEST_MESSAGE
                or message.param1 == mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
            )
            if version:
                extra = [_version()]
                result = mavlink.MAV_RESULT_ACCEPTED
        ack = mavlink.MAVLink_command_ack_message(
            message.command, result, 0, 0, message.get_srcSystem(), message.get_srcComponent()
        )
        return [ack, *extra]

    def _set_interval(self, name: str, interval_us: float) -> None:
        self._interval[name] = interval_us * 1e-6 if interval_us > 0 else math.inf
        self._due[name] = 0.0

    def _set_group(self, group: str, rate_hz: float) -> None:
        for name in STREAM_GROUPS[group]:
            self._set_interval(name, 1e6 / rate_hz if rate_hz > 0 else -1.0)

    def _set_parameter(self, message: Message) -> list[Message]:
        name = message.param_id.rstrip("\0")
        if name not in self.parameters:
            return []
        self.parameters[name] = message.param_value
        if name.startswith("SR0_"):
            self._set_group(name.removeprefix("SR0_"), message.param_value)
        return [self._parameter(name)]

    def _parameter_asked(self, message: Message) -> list[Message]:
        names = list(self.parameters)
        if 0 <= message.param_index < len(names):
            return [self._parameter(names[message.param_index])]
        name = message.param_id.rstrip("\0")
        return [self._parameter(name)] if name in self.parameters else []

    def _parameter(self, name: str) -> Message:
        index = list(self.parameters).index(name)
        value, count = float(self.parameters[name]), len(self.parameters)
        return mavlink.MAVLink_param_value_message(name.encode(), value, parameter_type(name), count, index)

    def _heartbeat(self, sample: Sample, boot_s: float) -> Message:
        return mavlink.MAVLink_heartbeat_message(
            mavlink.MAV_TYPE_FIXED_WING,
            mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
            ARMED_MANUAL if sample.mode == MANUAL else ARMED_CRUISE,
            sample.mode,
            mavlink.MAV_STATE_ACTIVE,
            3,
        )

    def _system_time(self, sample: Sample, boot_s: float) -> Message:
        unix_us = round(1e6 * (self._clock.unix_s + sample.time_s))
        return mavlink.MAVLink_system_time_message(unix_us, _milliseconds(boot_s))

    def _attitude(self, sample: Sample, boot_s: float) -> Message:
        r = sample.reading
        return mavlink.MAVLink_attitude_message(_milliseconds(boot_s), r.phi, r.theta, 0.0, r.p, r.q, r.r)

    def _aoa_ssa(self, sample: Sample, boot_s: float) -> Message:
        # ArduPilot fills this 64-bit field from a 32-bit counter.
        stamp = round(1e6 * boot_s) % 2**32
        return mavlink.MAVLink_aoa_ssa_message(stamp, math.degrees(sample.reading.alpha), 0.0)

    def _servo_output_raw(self, sample: Sample, boot_s: float) -> Message:
        middle, low = self._calibration.trim_us, self._calibration.low_us
        half = self._calibration.high_us - middle
        outputs = [
            round(middle + half * sample.aileron),
            sample.pulse_us,
            round(low + 2 * half * sample.throttle),
            round(middle + half * sample.rudder),
        ]
        stamp = round(1e6 * (boot_s + self._output_late_s)) % 2**32
        return mavlink.MAVLink_servo_output_raw_message(stamp, 0, *outputs, *([0] * 12))

    def _rc_channels(self, sample: Sample, boot_s: float) -> Message:
        """Return the receiver's channels. The sticks are at rest, and the switch on channel 9 is on during a
        manoeuvre.
        """
        pulses = [1500] * 8 + [SWITCH_ON_US if sample.flying else SWITCH_OFF_US] + [0] * 9
        return mavlink.MAVLink_rc_channels_message(_milliseconds(boot_s), 9, *pulses, 255)

    def _raw_imu(self, sample: Sample, boot_s: float) -> Message:
        r = sample.reading
        force = [round(1e3 * a / GRAVITY_M_S2) for a in (r.a_x, r.a_y, r.a_z)]
        gyro = [round(1e3 * rate) for rate in (r.p, r.q, r.r)]
        return mavlink.MAVLink_raw_imu_message(
            round(1e6 * boot_s), *(_int16(v) for v in force), *(_int16(v) for v in gyro), 0, 0, 0, 0, 2000
        )

    def _vfr_hud(self, sample: Sample, boot_s: float) -> Message:
        r = sample.reading
        ground = r.airspeed * math.cos(r.theta - sample.motion.alpha)
        return mavlink.MAVLink_vfr_hud_message(
            r.airspeed, ground, 0, round(100 * sample.throttle), HOME_HEIGHT_M + r.height, r.climb
        )

    def _global_position_int(self, sample: Sample, boot_s: float) -> Message:
        r = sample.reading
        latitude = HOME_LATITUDE + sample.north_m / METRES_PER_DEGREE
        longitude = HOME_LONGITUDE + sample.east_m / METRES_PER_DEGREE
        ground = r.airspeed * math.cos(r.theta - sample.motion.alpha)
        return mavlink.MAVLink_global_position_int_message(
            _milliseconds(boot_s),
            round(1e7 * latitude),
            round(1e7 * longitude),
            round(1e3 * (HOME_HEIGHT_M + r.height)),
            round(1e3 * r.height),
            _int16(round(100 * ground)),
            0,
            _int16(round(-100 * r.climb)),
            0,
        )


def _name_of(message_id: int) -> str:
    known = mavlink.mavlink_map.get(message_id)
    return str(known.msgname) if known else ""


def _version() -> Message:
    major, minor, patch = VERSION
    software = major << 24 | minor << 16 | patch << 8 | 255
    capabilities = int(mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2)
    return mavlink.MAVLink_autopilot_version_message(
        capabilities, software, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0, [0] * 18
    )


def _milliseconds(boot_s: float) -> int:
    return round(1e3 * boot_s) % 2**32


def _int16(value: int) -> int:
    return min(max(value, -32768), 32767)
