"""Identity of an aircraft in the texts of a script: a short name, and a hash of the calibration.

A text of an autopilot has 50 characters, so that a long name is cut.
"""

import hashlib
import json
from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft
from advisor.words.printable import printable

MOST_CHARACTERS = 20
"""Longest name in a text of 50 characters, next to ``ADVISOR SCRIPT`` and a hash of eight digits."""
_CONTROLS = ("elevator", "aileron", "rudder")


@dataclass(frozen=True, slots=True)
class ScriptIdentity:
    """Name and hash that a script states for an aircraft."""

    name: str
    calibration_hash: str
    """Eight digits that change with any calibration or stated output."""

    @classmethod
    def of(cls, aircraft: Aircraft) -> "ScriptIdentity":
        """Return the identity of an aircraft file."""
        name = printable(aircraft.name).encode("ascii", "replace").decode()[:MOST_CHARACTERS].strip()
        controls = [getattr(aircraft, control) for control in _CONTROLS]
        stated = [[one.output, one.calibration] for one in controls]
        several = [[one.output, one.weight, one.calibration] for one in aircraft.elevator.outputs]
        text = json.dumps([stated, several])
        return cls(name or Aircraft.name, hashlib.sha256(text.encode()).hexdigest()[:8])

    @classmethod
    def of_file(cls, aircraft: Aircraft) -> "ScriptIdentity | None":
        """Return the identity of an aircraft file; None where no file names or calibrates the aircraft."""
        mine = cls.of(aircraft)
        return None if mine == cls.of(Aircraft()) else mine
