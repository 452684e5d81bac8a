"""Comparison of a campaign's flights: whether all are those of one aircraft."""

import numpy as np

from advisor.flight.vehicle.surfaces import Surface
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.problems import Problem

_PROBE_US = (1400.0, 1600.0)
"""Pulses at which two elevators' scales are compared, us: within the travel of every servo."""
_SCALES_AGREE = 0.05
"""Largest relative difference of an elevator's scale between flights of one aircraft, as after a new trim."""


class OneAircraft:
    """Comparison of each flight's vehicle and elevator with those of the first flight."""

    def __init__(self) -> None:
        self._vehicle: tuple[str, Vehicle] | None = None
        self._elevator: tuple[str, Surface] | None = None

    def refuse(self, name: str, vehicle: Vehicle) -> Problem | None:
        """Return a problem if the vehicle of a flight is certainly another aircraft; else None."""
        first_name, first = self._vehicle = self._vehicle or (name, vehicle)
        if _kind(vehicle) == _kind(first):
            return None
        return Problem(
            "other_vehicle",
            f"The vehicle is {_kind(vehicle)}, and {_kind(first)} in {first_name}:"
            " one campaign needs one aircraft.",
            "Give the logs of one aircraft only.",
        )

    def other_system(self, name: str, vehicle: Vehicle) -> str:
        """Return a sentence if the vehicle's system id differs from the first flight's; else ""."""
        first_name, first = self._vehicle = self._vehicle or (name, vehicle)
        if vehicle.system == first.system:
            return ""
        return f"{name}: the vehicle is {vehicle}, and {first} in {first_name}; both count as one aircraft."

    def doubt_elevator(self, name: str, elevator: Surface) -> str:
        """Return a sentence if the elevator is driven differently from the first flight's; else ""."""
        first_name, first = self._elevator = self._elevator or (name, elevator)
        if elevator.outputs == first.outputs and _scales_agree(elevator, first):
            return ""
        outputs, before = (" + ".join(map(str, surface.outputs)) for surface in (elevator, first))
        return (
            f"{name}: the elevator is output {outputs} with a scale of its own, and output {before} in "
            f"{first_name}; both count as one aircraft."
        )


def _kind(vehicle: Vehicle) -> str:
    """Return the vehicle's properties that no setting changes, such as the autopilot's make."""
    return f"{vehicle.autopilot} on a {'multicopter' if vehicle.is_multicopter else 'fixed wing'}"


def _scales_agree(a: Surface, b: Surface) -> bool:
    steps = [np.diff(s.angles(np.tile(np.array(_PROBE_US)[:, None], len(s.parts))), axis=0) for s in (a, b)]
    return bool(np.allclose(steps[0], steps[1], rtol=_SCALES_AGREE))
