"""Identity of the aircraft file for which a script in the autopilot was written."""

import hashlib
import json
from dataclasses import dataclass
from typing import Self

from advisor.aircraft.aircraft import Aircraft
from advisor.words.ascii_output import printable

_LETTERS = 20
"""Longest name, with which the text ``ADVISOR SCRIPT name hash`` has less than 50 bytes."""


@dataclass(frozen=True, slots=True)
class ScriptIdentity:
    """Name and calibrations of an aircraft file, as the texts of a script state them."""

    name: str
    """Name of the aircraft in ASCII, short enough for a text of 50 bytes."""
    calibration: str
    """Hash that changes with any calibration or stated output."""

    @classmethod
    def of(cls, aircraft: Aircraft) -> Self:
        name = printable(aircraft.name).encode("ascii", "replace").decode()[:_LETTERS].strip()
        elevator = aircraft.elevator
        stated = [(each.output, each.calibration) for each in (elevator, aircraft.aileron, aircraft.rudder)]
        parts = [(each.output, each.calibration, each.weight) for each in elevator.outputs]
        text = json.dumps([stated, parts])
        return cls(name, hashlib.sha256(text.encode()).hexdigest()[:8])
