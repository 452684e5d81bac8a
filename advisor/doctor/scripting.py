"""Check of the vehicle's parameters: whether the vehicle can fly a script of ``advisor script``."""

from collections.abc import Mapping, Sequence

from advisor.flight.signals.messages import Columns
from advisor.flight.stream.surfaces_heard import speakers
from advisor.flight.vehicle.parameters import Parameters
from advisor.flight.vehicle.surfaces import Surface
from advisor.flight.vehicle.vehicle import Vehicle

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
        """Take parameter messages."""
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
