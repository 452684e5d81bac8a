"""Parameters of an autopilot that give the elevator's output and its scale."""

import struct
from collections.abc import Sequence
from typing import Protocol

from pymavlink.dialects.v20 import ardupilotmega as dialect

OUTPUTS = range(1, 17)
_FUNCTIONS = [f"FUNC{k}" for k in range(1, 9)]
"""Functions of the eight outputs that a bank of PX4 has at most."""
_SERVOS = range(201, 217)
"""Output functions of PX4 that are servos."""
PITCH_FUNCTIONS = (19, 77, 78, 79, 80, 16, 17, 86, 87)
"""SERVOn_FUNCTION of elevator, left and right elevon, left and right V-tail, differential spoilers."""

STREAM_GROUPS = ("EXTRA1", "RAW_SENS", "RC_CHAN", "EXTRA2")
RENAMED = {
    "SYSID_MYGCS": "MAV_GCS_SYSID",
    **{f"SR0_{group}": f"MAV1_{group}" for group in STREAM_GROUPS},
}
"""Name of a parameter up to ArduPilot 4.6 to its later name. A vehicle knows one of the two names, so that
both are requested."""


class Questions(Protocol):
    """The parameters of one kind of autopilot."""

    outputs: Sequence[str]
    """Parameters that show which output is the elevator."""
    first: Sequence[str]
    """Parameters that are requested in any case."""

    def value(self, payload: bytes) -> float:
        """Return the value in a PARAM_VALUE."""

    def follow(self, name: str, value: float) -> list[str]:
        """Return the parameters that an answer makes useful."""


class ArduPilotQuestions:
    """SERVOn_FUNCTION of every output, the stream rates and the ground station's id in both spellings."""

    outputs: Sequence[str] = tuple(f"SERVO{n}_FUNCTION" for n in OUTPUTS)
    first: Sequence[str] = (*outputs, *(name for pair in RENAMED.items() for name in pair))

    def value(self, payload: bytes) -> float:
        """Return the value, which ArduPilot sends converted to floating point."""
        return float(struct.unpack_from("<f", payload)[0])

    def follow(self, name: str, value: float) -> list[str]:
        """Return MIN, TRIM, MAX and REVERSED of the outputs that pitch."""
        stem, _, kind = name.rpartition("_")
        if kind != "FUNCTION" or not stem.startswith("SERVO") or value not in PITCH_FUNCTIONS:
            return []
        return [f"{stem}_{detail}" for detail in ("MIN", "TRIM", "MAX", "REVERSED")]


class Px4Questions:
    """CA_SV_CSn_TYPE of every surface and the functions of the outputs on the two PWM banks."""

    outputs: Sequence[str] = (
        "CA_SV_CS_COUNT",
        *(f"CA_SV_CS{n}_TYPE" for n in range(8)),
        *(f"{bank}_{what}" for bank in ("PWM_MAIN", "PWM_AUX") for what in ("REV", *_FUNCTIONS)),
    )
    first = outputs

    def value(self, payload: bytes) -> float:
        """Return the value, which PX4 sends as bytes of an integer."""
        is_float = payload[24] == dialect.MAV_PARAM_TYPE_REAL32
        return float(struct.unpack_from("<f" if is_float else "<i", payload)[0])

    def follow(self, name: str, value: float) -> list[str]:
        """Return the torque in pitch of every surface, and the limits of the outputs that drive one."""
        if name.startswith("CA_SV_CS") and name.endswith("_TYPE") and value:
            return [f"{name.removesuffix('_TYPE')}_TRQ_P"]
        bank, _, number = name.partition("_FUNC")
        return [f"{bank}_{end}{number}" for end in ("MIN", "MAX")] if number and value in _SERVOS else []
