"""Aileron and rudder: their servo outputs and mixing.

With ``Scale`` a positive deflection is trailing edge down for a positive pulse in reverse. Positive aileron
is the right half's trailing edge down, which rolls the aircraft to the left. A positive rudder yaws to the
left. The rows of ``mixers.py`` give each output's share.
"""

from dataclasses import replace
from typing import Literal

from advisor.aircraft.controls import SideControl
from advisor.flight.elevator.elevator_outputs import parts_of, without_calibration
from advisor.flight.vehicle.surfaces import Calibration, Part, Surface, joined_numbers
from advisor.flight.vehicle.wiring import Wiring

Side = Literal["aileron", "rudder"]
SIDES: tuple[Side, ...] = ("aileron", "rudder")


def find_side_control(name: Side, stated: SideControl, wiring: Wiring) -> Surface | None:
    """Return the servo outputs of the aileron or the rudder with their scales; None if no source states them.

    Parameters
    ----------
    stated
        Aileron or rudder in the aircraft file. A calibration of one output also applies to the other outputs.
    wiring
        Roles and scales of outputs by the vehicle's parameters; may be empty.
    """
    given = None if stated.calibration is None else Calibration(stated.calibration)
    if stated.output != "auto":
        part = Part(stated.output, given or wiring.scale(stated.output))
        return Surface((part,), True, "") if given else _uncalibrated((part,), name, wiring)
    parts = parts_of(name, wiring)
    if not parts:
        return None
    if given is None:
        return _uncalibrated(parts, name, wiring)
    return Surface(tuple(_calibrated(part, parts[0], given, wiring) for part in parts), True, "")


def _uncalibrated(parts: tuple[Part, ...], name: Side, wiring: Wiring) -> Surface:
    outputs = joined_numbers([part.output for part in parts])
    several = len(parts) > 1
    begin = f"No {name}.calibration: output{'s' if several else ''} {outputs} {'are' if several else 'is'}"
    derivatives = "Y_{0}, L_{0} and N_{0}".format("δa" if name == "aileron" else "δr")
    return without_calibration(parts, begin, derivatives, wiring)


def _calibrated(part: Part, first: Part, given: Calibration, wiring: Wiring) -> Part:
    """Return a part with the first output's calibration carried over."""
    if part.output == first.output:
        return replace(part, scale=given)
    return replace(part, scale=given.carried_over(wiring.scale(first.output), wiring.scale(part.output)))
