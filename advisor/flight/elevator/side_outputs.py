"""Aileron and rudder: their servo outputs and mixing.

One half of a mixed pair follows the demand of roll or yaw upwards, the other half downwards. Half of the
difference is the aileron or the rudder, and the demand that both follow alike cancels. With ``Scale`` a
positive deflection is trailing edge down for a positive pulse in reverse. So an aileron is positive where
the right half goes down, and rolls to the left. A rudder is positive where the left half of a V-tail goes
down, and yaws to the left (ArduPlane, ``servos.cpp``, channel_function_mixer).
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from advisor.aircraft.controls import SideControl
from advisor.flight.elevator.elevator_outputs import without_calibration
from advisor.flight.vehicle.surfaces import Calibration, Part, Surface, in_shares, joined_numbers
from advisor.flight.vehicle.wiring import AILERON, RUDDER, Role, Wiring

Side = Literal["aileron", "rudder"]
_PAIRS: Mapping[Side, Mapping[str, str]] = {
    "aileron": {"elevon": "right", "flaperon": "right", "differential spoiler": "right"},
    "rudder": {"V-tail": "left"},
}
"""Kind of a mixed pair to the half that counts positive."""
_PLAIN: Mapping[Side, Role] = {"aileron": AILERON, "rudder": RUDDER}


def find_side_control(name: Side, stated: SideControl, wiring: Wiring) -> Surface | None:
    """Return the outputs of the aileron or the rudder with their scales; None where nothing states them.

    Parameters
    ----------
    stated
        The control in the aircraft file. A calibration of one output is carried over to the others.
    wiring
        Roles and scales of outputs by the vehicle's parameters; may be empty.
    """
    given = None if stated.calibration is None else Calibration(stated.calibration)
    if stated.output != "auto":
        part = Part(stated.output, given or wiring.scale(stated.output))
        return Surface((part,), True, "") if given else _uncalibrated((part,), name, wiring)
    parts = [Part(n, wiring.scale(n), side=name) for n in wiring.outputs_of(_PLAIN[name])]
    parts += [
        Part(n, wiring.scale(n), 1.0 if side == positive else -1.0, side=f"{kind} {side}")
        for kind, positive in _PAIRS[name].items()
        for side in ("left", "right")
        for n in wiring.outputs_of(Role(kind, side))
        if wiring.outputs_of(Role(kind, "left")) and wiring.outputs_of(Role(kind, "right"))
    ]
    if not parts:
        return None
    ordered = in_shares(parts)
    if given is None:
        return _uncalibrated(ordered, name, wiring)
    return Surface(tuple(_calibrated(part, ordered[0], given, wiring) for part in ordered), True, "")


def _uncalibrated(parts: tuple[Part, ...], name: Side, wiring: Wiring) -> Surface:
    outputs = joined_numbers([part.output for part in parts])
    several = len(parts) > 1
    begin = f"No {name}.calibration: output{'s' if several else ''} {outputs} {'are' if several else 'is'}"
    derivatives = "Y_{0}, L_{0} and N_{0}".format("δa" if name == "aileron" else "δr")
    return without_calibration(parts, begin, derivatives, wiring)


def _calibrated(part: Part, first: Part, given: Calibration, wiring: Wiring) -> Part:
    """Return a part with the calibration of the first output, carried over."""
    if part.output == first.output:
        return replace(part, scale=given)
    return replace(part, scale=given.carried_over(wiring.scale(first.output), wiring.scale(part.output)))
