"""Small writers of the two kinds of log that autopilots keep themselves."""

import struct
from collections.abc import Sequence

FORMATS = {
    "FMT": (0x80, "BBnNZ", "Type,Length,Name,Format,Columns"),
    "ATT": (1, "QccccCCCCB", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw,AEKF"),
    "IMU": (2, "QBffffffIIfBBHH", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz"),
    "AOA": (3, "Qff", "TimeUS,AOA,SSA"),
    "RCOU": (4, "QHHHHHHHHHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14"),
    "RCO2": (5, "QHHHH", "TimeUS,C15,C16,C17,C18"),
    "CTUN": (6, "Qccccffffi", "TimeUS,NavRoll,Roll,NavPitch,Pitch,ThO,RdrO,ThD,As,SAs"),
    "ARSP": (7, "QBffcffBBffB", "TimeUS,I,Airspeed,DiffPress,Temp,RawPress,Offset,U,H,Hp,TR,Pri"),
    "BARO": (8, "QBffcfIffB", "TimeUS,I,Alt,Press,Temp,CRt,SMS,Offset,GndTemp,H"),
    "XKF1": (9, "QBccCfffffffccce", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH"),
    "PARM": (10, "QNff", "TimeUS,Name,Value,Default"),
    "MODE": (11, "QMBB", "TimeUS,Mode,ModeNum,Rsn"),
    "MSG": (12, "QZ", "TimeUS,Message"),
    "VER": (13, "QBHBBBBIZHBB", "TimeUS,BT,BST,Maj,Min,Pat,FWT,GH,FWS,APJ,BU,FV"),
    "GPS": (14, "QBBIHBcLLeffffB", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U"),
    "POS": (15, "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt"),
    "RCIN": (16, "QHHHHHHHHHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14"),
    "SIDS": (17, "QBfffffff", "TimeUS,Ax,Mag,FSt,FSp,TFin,TC,TR,TFout"),
    "SIDD": (18, "Qfffffffff", "TimeUS,Time,Targ,F,Gx,Gy,Gz,Ax,Ay,Az"),
}
_STRUCT = {
    "B": "B", "M": "B", "h": "h", "H": "H", "i": "i", "I": "I", "Q": "Q", "f": "f",
    "n": "4s", "N": "16s", "Z": "64s", "c": "h", "C": "H", "e": "i", "L": "i",
}  # fmt: skip
_SCALE = {"c": 100, "C": 100, "e": 100, "L": 1e7}


def dataflash_record(name: str, *values: object) -> bytes:
    """One record; values that are left out are zero."""
    number, form, _ = FORMATS[name]
    body = b""
    for i, character in enumerate(form):
        value = values[i] if i < len(values) else (b"" if _STRUCT[character].endswith("s") else 0)
        if character in _SCALE:
            value = round(value * _SCALE[character])
        body += struct.pack("<" + _STRUCT[character], value)
    return bytes([0xA3, 0x95, number]) + body


def dataflash_head() -> bytes:
    """The FMT records that a log begins with."""
    return b"".join(
        dataflash_record(
            "FMT", number, len(dataflash_record(name)), name.encode(), form.encode(), columns.encode()
        )
        for name, (number, form, columns) in FORMATS.items()
    )


TOPICS = {
    "vehicle_attitude": "uint64_t timestamp;uint64_t timestamp_sample;float[4] q;",
    "vehicle_angular_velocity": "uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;",
    "sensor_combined": "uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;",
    "actuator_outputs": "uint64_t timestamp;uint32_t noutputs;float[16] output;",
    "airspeed_validated": "uint64_t timestamp;float calibrated_airspeed_m_s;",
    "vehicle_local_position": "uint64_t timestamp;uint64_t timestamp_sample;float z;float vz;",
    "vehicle_thrust_setpoint": "uint64_t timestamp;float[3] xyz;",
    "vehicle_status": "uint64_t timestamp;uint8_t nav_state;uint8_t vehicle_type;",
    "vehicle_gps_position": "uint64_t timestamp;uint64_t time_utc_usec;",
    "input_rc": "uint64_t timestamp;uint16_t[18] values;",
    "debug_key_value": "uint64_t timestamp;char[10] key;float value;",
}
_SIZES = {"uint64_t": "Q", "uint32_t": "I", "uint16_t": "H", "uint8_t": "B", "float": "f", "char": "s"}


def _ulog_message(kind: str, payload: bytes) -> bytes:
    return struct.pack("<HB", len(payload), ord(kind)) + payload


def ulog_head(*definitions: bytes) -> bytes:
    """Header, formats, parameters and other definitions, and subscriptions to all ``TOPICS``."""
    formats = [_ulog_message("F", f"{name}:{fields}".encode()) for name, fields in TOPICS.items()]
    subscriptions = [
        _ulog_message("A", struct.pack("<BH", 0, number) + name.encode())
        for number, name in enumerate(TOPICS)
    ]
    return b"ULog\x01\x12\x35\x01" + bytes(8) + b"".join([*formats, *definitions, *subscriptions])


def ulog_data(topic: str, *values: object) -> bytes:
    """One sample; arrays are given as sequences."""
    body = b""
    for field, value in zip(TOPICS[topic].rstrip(";").split(";"), values, strict=True):
        kind, _, length = field.split()[0].rstrip("]").partition("[")
        if kind == "char":
            body += struct.pack(f"<{length}s", value)
        elif length:
            assert isinstance(value, Sequence)
            body += struct.pack(f"<{length}{_SIZES[kind]}", *value)
        else:
            body += struct.pack(f"<{_SIZES[kind]}", value)
    return _ulog_message("D", struct.pack("<H", list(TOPICS).index(topic)) + body)


def ulog_parameter(name: str, value: float) -> bytes:
    key = f"float {name}".encode()
    return _ulog_message("P", bytes([len(key)]) + key + struct.pack("<f", value))


def ulog_release(version: int) -> bytes:
    key = b"uint32_t ver_sw_release"
    return _ulog_message("I", bytes([len(key)]) + key + struct.pack("<I", version))


def ulog_text(time_us: int, level: int, text: str) -> bytes:
    return _ulog_message("L", struct.pack("<BQ", ord("0") + level, time_us) + text.encode())
