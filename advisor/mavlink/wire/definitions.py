"""MAVLink messages that the advisor reads: ids, fields, and layouts in the frame.

One line for each message, from the MAVLink definitions (common.xml, ardupilotmega.xml): ``NAME id: type
field, ... + extension fields of MAVLink 2``. The order on the wire and the seed of the checksum follow from
the protocol's rules. Reading a log needs no dialect of pymavlink, whose import costs at least 0.1 s.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from advisor.mavlink.wire.checksum import crc16

_DEFINITIONS = """
HEARTBEAT 0: uint8 type, uint8 autopilot, uint8 base_mode, uint32 custom_mode, uint8 system_status, uint8
    mavlink_version
SYSTEM_TIME 2: uint64 time_unix_usec, uint32 time_boot_ms
PARAM_VALUE 22: char[16] param_id, float param_value, uint8 param_type, uint16 param_count, uint16
    param_index
GPS_RAW_INT 24: uint64 time_usec, uint8 fix_type, int32 lat, int32 lon, int32 alt, uint16 eph, uint16 epv,
    uint16 vel, uint16 cog, uint8 satellites_visible + int32 alt_ellipsoid, uint32 h_acc, uint32 v_acc,
    uint32 vel_acc, uint32 hdg_acc, uint16 yaw
SCALED_IMU 26: uint32 time_boot_ms, int16 xacc, int16 yacc, int16 zacc, int16 xgyro, int16 ygyro, int16
    zgyro, int16 xmag, int16 ymag, int16 zmag + int16 temperature
RAW_IMU 27: uint64 time_usec, int16 xacc, int16 yacc, int16 zacc, int16 xgyro, int16 ygyro, int16 zgyro,
    int16 xmag, int16 ymag, int16 zmag + uint8 id, int16 temperature
SCALED_PRESSURE 29: uint32 time_boot_ms, float press_abs, float press_diff, int16 temperature + int16
    temperature_press_diff
ATTITUDE 30: uint32 time_boot_ms, float roll, float pitch, float yaw, float rollspeed, float pitchspeed,
    float yawspeed
ATTITUDE_QUATERNION 31: uint32 time_boot_ms, float q1, float q2, float q3, float q4, float rollspeed, float
    pitchspeed, float yawspeed + float[4] repr_offset_q
LOCAL_POSITION_NED 32: uint32 time_boot_ms, float x, float y, float z, float vx, float vy, float vz
GLOBAL_POSITION_INT 33: uint32 time_boot_ms, int32 lat, int32 lon, int32 alt, int32 relative_alt, int16 vx,
    int16 vy, int16 vz, uint16 hdg
SERVO_OUTPUT_RAW 36: uint32 time_usec, uint8 port, uint16 servo1_raw, uint16 servo2_raw, uint16 servo3_raw,
    uint16 servo4_raw, uint16 servo5_raw, uint16 servo6_raw, uint16 servo7_raw, uint16 servo8_raw + uint16
    servo9_raw, uint16 servo10_raw, uint16 servo11_raw, uint16 servo12_raw, uint16 servo13_raw, uint16
    servo14_raw, uint16 servo15_raw, uint16 servo16_raw
RC_CHANNELS 65: uint32 time_boot_ms, uint8 chancount, uint16 chan1_raw, uint16 chan2_raw, uint16 chan3_raw,
    uint16 chan4_raw, uint16 chan5_raw, uint16 chan6_raw, uint16 chan7_raw, uint16 chan8_raw, uint16
    chan9_raw, uint16 chan10_raw, uint16 chan11_raw, uint16 chan12_raw, uint16 chan13_raw, uint16
    chan14_raw, uint16 chan15_raw, uint16 chan16_raw, uint16 chan17_raw, uint16 chan18_raw, uint8 rssi
VFR_HUD 74: float airspeed, float groundspeed, int16 heading, uint16 throttle, float alt, float climb
COMMAND_LONG 76: uint8 target_system, uint8 target_component, uint16 command, uint8 confirmation, float
    param1, float param2, float param3, float param4, float param5, float param6, float param7
COMMAND_ACK 77: uint16 command, uint8 result + uint8 progress, int32 result_param2, uint8 target_system,
    uint8 target_component
HIGHRES_IMU 105: uint64 time_usec, float xacc, float yacc, float zacc, float xgyro, float ygyro, float
    zgyro, float xmag, float ymag, float zmag, float abs_pressure, float diff_pressure, float pressure_alt,
    float temperature, uint16 fields_updated + uint8 id
RADIO_STATUS 109: uint8 rssi, uint8 remrssi, uint8 txbuf, uint8 noise, uint8 remnoise, uint16 rxerrors,
    uint16 fixed
FILE_TRANSFER_PROTOCOL 110: uint8 target_network, uint8 target_system, uint8 target_component, uint8[251]
    payload
SCALED_IMU2 116: uint32 time_boot_ms, int16 xacc, int16 yacc, int16 zacc, int16 xgyro, int16 ygyro, int16
    zgyro, int16 xmag, int16 ymag, int16 zmag + int16 temperature
SCALED_IMU3 129: uint32 time_boot_ms, int16 xacc, int16 yacc, int16 zacc, int16 xgyro, int16 ygyro, int16
    zgyro, int16 xmag, int16 ymag, int16 zmag + int16 temperature
AUTOPILOT_VERSION 148: uint64 capabilities, uint32 flight_sw_version, uint32 middleware_sw_version, uint32
    os_sw_version, uint32 board_version, uint8[8] flight_custom_version, uint8[8] middleware_custom_version,
    uint8[8] os_custom_version, uint16 vendor_id, uint16 product_id, uint64 uid + uint8[18] uid2
RADIO 166: uint8 rssi, uint8 remrssi, uint8 txbuf, uint8 noise, uint8 remnoise, uint16 rxerrors, uint16
    fixed
WIND 168: float direction, float speed, float speed_z
WIND_COV 231: uint64 time_usec, float wind_x, float wind_y, float wind_z, float var_horiz, float var_vert,
    float wind_alt, float horiz_accuracy, float vert_accuracy
VIBRATION 241: uint64 time_usec, float vibration_x, float vibration_y, float vibration_z, uint32 clipping_0,
    uint32 clipping_1, uint32 clipping_2
MESSAGE_INTERVAL 244: uint16 message_id, int32 interval_us
EXTENDED_SYS_STATE 245: uint8 vtol_state, uint8 landed_state
NAMED_VALUE_FLOAT 251: uint32 time_boot_ms, char[10] name, float value
STATUSTEXT 253: uint8 severity, char[50] text + uint16 id, uint8 chunk_seq
AIRSPEED 295: uint8 id, float airspeed, int16 temperature, float raw_press, uint8 flags
ACTUATOR_OUTPUT_STATUS 375: uint64 time_usec, uint32 active, float[32] actuator
AOA_SSA 11020: uint64 time_usec, float AOA, float SSA
"""

_SCALARS = {
    "char": "S1",
    "int8": "i1",
    "uint8": "u1",
    "int16": "<i2",
    "uint16": "<u2",
    "int32": "<i4",
    "uint32": "<u4",
    "int64": "<i8",
    "uint64": "<u8",
    "float": "<f4",
    "double": "<f8",
}


@dataclass(frozen=True, slots=True)
class _Field:
    name: str
    type: str
    length: int
    """Number of elements of an array field, 0 for a scalar."""

    @classmethod
    def parse(cls, text: str) -> "_Field":
        kind, name = text.split()
        kind, _, length = kind.rstrip("]").partition("[")
        return cls(name, kind, int(length or 0))

    @property
    def scalar_size(self) -> int:
        return np.dtype(_SCALARS[self.type]).itemsize

    @property
    def column(self) -> tuple[Any, ...]:
        if self.type == "char":
            return (self.name, f"S{self.length}")
        if self.length:
            return (self.name, _SCALARS[self.type], (self.length,))
        return (self.name, _SCALARS[self.type])

    @property
    def signature(self) -> bytes:
        """Contribution of the field to the seed of the checksum."""
        c_type = self.type if self.type in ("char", "float", "double") else f"{self.type}_t"
        return f"{c_type} {self.name} ".encode() + (bytes([self.length]) if self.length else b"")


@dataclass(frozen=True, slots=True)
class Definition:
    """One message type."""

    name: str
    id: int
    crc_extra: int
    """Seed that distinguishes versions of a message; last byte of every checksum."""
    layout: "np.dtype[np.void]"
    """Structured dtype in wire order, extension fields of MAVLink 2 at the end, no padding."""


def _parse(line: str) -> Definition:
    head, _, body = line.partition(": ")
    name, number = head.split()
    base, extensions = (
        [_Field.parse(field) for field in part.split(", ") if field] for part in (*body.split(" + "), "")[:2]
    )
    # Order on the wire: the largest scalars first, otherwise as defined. Extensions are not sorted.
    base.sort(key=lambda field: -field.scalar_size)
    seed = crc16(f"{name} ".encode() + b"".join(field.signature for field in base))
    layout = np.dtype([field.column for field in (*base, *extensions)])
    return Definition(name, int(number), seed & 0xFF ^ seed >> 8, layout)


DEFINITIONS = {
    definition.name: definition
    for definition in map(_parse, _DEFINITIONS.replace("\n    ", " ").strip().splitlines())
}
"""Every message that the advisor can read, by name."""
