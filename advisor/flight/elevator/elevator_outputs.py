"""Elevator, aileron and rudder: their servo outputs, their mixing, and sentences about both for the user.

The rows of ``mixers.py`` give each output's share. With ``Scale`` a positive deflection is trailing edge down
for a positive pulse in reverse. Positive aileron is the right half's trailing edge down, which rolls the
aircraft to the left. A positive rudder yaws to the left.
"""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Literal

from advisor.aircraft.aircraft import Elevator, ElevatorOutput, Pairs, SideControl
from advisor.flight.vehicle.mixers import NOTHING, ROWS, Control, Role, sides_of
from advisor.flight.vehicle.surfaces import (
    Calibration,
    Part,
    Surface,
    Wiring,
    in_shares,
    joined_numbers,
    listed,
)
from advisor.words.problems import Problem

_AXES: Mapping[Control, str] = {"aileron": "roll", "rudder": "yaw"}
"""Axis in which the members of a mixed pair cancel, by the other control that the pair drives."""

Side = Literal["aileron", "rudder"]
SIDES: tuple[Side, ...] = ("aileron", "rudder")
_DERIVATIVES = {
    "elevator": "Z_δe and M_δe",
    "aileron": "Y_δa, L_δa and N_δa",
    "rudder": "Y_δr, L_δr and N_δr",
}
"""Derivatives that the scale of each control divides."""


def find_elevator(
    elevator: Elevator, wiring: Wiring, why: str = "as the aircraft file says"
) -> Surface | Problem:
    """Return the outputs of the elevator with their scales, or a problem.

    Parameters
    ----------
    wiring
        Roles and scales of outputs by the vehicle's parameters; may be empty.
    """
    if elevator.outputs:
        return _as_listed(elevator.outputs, wiring)
    if elevator.output != "auto":
        return _as_given(elevator.output, elevator.calibration, wiring, why)
    return _as_found(elevator.calibration, wiring)


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
    parts = parts_of(name, wiring)
    if stated.output != "auto":
        parts = (Part(stated.output, given or wiring.scale(stated.output)),)
    if not parts:
        return None
    if given is not None:
        return Surface(_in_scale_of(parts, given, wiring), True, "")
    outputs = f"output{'s' if len(parts) > 1 else ''} {joined_numbers(_numbers(parts))}"
    begin = f"No {name}.calibration: {outputs} {'are' if len(parts) > 1 else 'is'}"
    return _without_calibration(parts, begin, name, wiring)


def _in_scale_of(parts: Sequence[Part], given: Calibration, wiring: Wiring) -> tuple[Part, ...]:
    """Return the parts with the first output's calibration carried over to the other outputs."""
    first = parts[0].output
    scales = (given.carried_over(wiring.scale(first), wiring.scale(part.output)) for part in parts)
    return tuple(
        replace(part, scale=given if part.output == first else scale)
        for part, scale in zip(parts, scales, strict=True)
    )


def _as_listed(outputs: Sequence[ElevatorOutput], wiring: Wiring) -> Surface | Problem:
    if len(outputs) == 1:
        return _as_given(outputs[0].output, outputs[0].calibration, wiring, "as the aircraft file says")
    parts = in_shares(
        Part(
            output.output,
            Calibration(output.calibration) if output.calibration else wiring.scale(output.output),
            output.weight,
            output.calibration is not None or _has_known_direction(output.output, wiring),
        )
        for output in outputs
    )
    calibrated = outputs[0].calibration is not None
    halves = {wiring.roles[n] for n in _numbers(parts) if _is_half(n, wiring)}
    said = [_formed(parts, "as the aircraft file says", sorted({half.surface for half in halves}))]
    said += [
        f"Only one side of the {kind} pair is among them: its other axis counts as elevator as well."
        for kind in _one_sided(halves)
    ]
    if calibrated:
        return Surface(parts, True, " ".join(said))
    return _scaled(parts, " ".join(said), wiring)


def _as_given(output: int, calibration: Pairs | None, wiring: Wiring, why: str) -> Surface | Problem:
    mixed = wiring.roles[output].surface if _is_half(output, wiring) else ""
    if calibration is None:
        if mixed:
            return Problem(
                "no_elevator",
                f"Output {output} is one half of a mixed {mixed} pair, not an elevator.",
                "Set elevator.output to auto: both halves are then read together. "
                "The other choice is to list both in elevator.outputs.",
            )
        return _uncalibrated(Part(output, wiring.scale(output)), why, wiring)
    said = (
        f"Output {output} is one half of a mixed {mixed} pair, calibrated as an elevator in the aircraft "
        "file. The part of such an output for the other axis counts as elevator as well."
    )
    return Surface((Part(output, Calibration(calibration)),), True, said if mixed else "")


def _as_found(calibration: Pairs | None, wiring: Wiring) -> Surface | Problem:
    parts = parts_of("elevator", wiring)
    if not parts:
        return _nothing_found(wiring)
    kinds = list(dict.fromkeys(wiring.roles[n].surface for n in _numbers(parts) if _is_half(n, wiring)))
    if calibration is not None:
        return _carried_over(calibration, parts, kinds, wiring)
    if len(parts) == 1:
        return _uncalibrated(parts[0], _why(kinds, wiring), wiring)
    return _scaled(parts, _formed(parts, _why(kinds, wiring), kinds), wiring)


def _carried_over(
    calibration: Pairs, parts: Sequence[Part], kinds: Sequence[str], wiring: Wiring
) -> Surface | Problem:
    """Return the surface with the first output's calibration carried over to its other outputs."""
    first, *others = _numbers(parts)
    if not others:
        return Surface((Part(first, Calibration(calibration)),), True, "")
    unknown = [n for n in (first, *others) if n not in wiring.known_directions]
    if unknown:
        return Problem(
            "no_elevator",
            f"elevator.calibration describes one output, but outputs {joined_numbers((first, *others))} act "
            f"together, and {wiring.words.sense.format(n=unknown[0])} is not known.",
            "Replace elevator.output by elevator.outputs, with a calibration for each output.",
        )
    carried = _in_scale_of(parts, Calibration(calibration), wiring)
    turned = [n for n in others if wiring.scale(n).reversed != wiring.scale(first).reversed]
    way = (
        f", the other way round for {joined_numbers(turned)} ({wiring.words.sense.format(n='n')})"
        if turned
        else ""
    )
    said = (
        f"elevator.calibration is taken for output {first} and carried over to {joined_numbers(others)}, "
        f"counted from {wiring.words.trim}{way}; elevator.outputs can hold one for each."
    )
    return Surface(carried, True, f"{_formed(carried, _why(kinds, wiring), kinds)} {said}")


def _uncalibrated(part: Part, why: str, wiring: Wiring) -> Surface:
    begin = f"No elevator.calibration: output {part.output} ({why}) is"
    return _without_calibration((part,), begin, "elevator", wiring)


def _scaled(parts: tuple[Part, ...], formed: str, wiring: Wiring) -> Surface:
    """Return the surface of several outputs without a calibration, with a scale from their limits."""
    return _without_calibration(parts, f"{formed} No calibration: they are", "elevator", wiring)


def _without_calibration(parts: tuple[Part, ...], begin: str, control: str, wiring: Wiring) -> Surface:
    """Return a control whose outputs have no calibration, with a sentence on its assumed scale.

    Parameters
    ----------
    begin
        Beginning of the sentence on the missing calibration, up to the verb.
    """
    doubts = tuple(doubt for n in _numbers(parts) if (doubt := wiring.limits_problem(n)) is not None)
    limits = "assumed limits" if doubts else wiring.words.limits
    divided = _DERIVATIVES[control]
    said = f"{begin} scaled by {limits} as full travel of 25 deg, so {divided} are per assumed degree."
    return Surface(parts, False, " ".join([said, *map(str, doubts)]), doubts)


def _is_half(n: int, wiring: Wiring) -> bool:
    """Return whether output ``n`` is one half of a pair that also pitches the aircraft."""
    return n in wiring.roles and wiring.roles[n].is_mixed and bool(wiring.roles[n].elevator)


def _has_known_direction(n: int, wiring: Wiring) -> bool:
    """Return whether the parameters give the direction in which a pitch demand moves output ``n``."""
    return n in wiring.known_directions and bool(wiring.roles.get(n, NOTHING).elevator)


def _formed(parts: Sequence[Part], why: str, kinds: Sequence[str]) -> str:
    """Return a sentence on the outputs that together form the elevator."""
    if len({part.share for part in parts}) == 1:
        made = f"the mean of outputs {joined_numbers(_numbers(parts))}"
    else:
        made = listed([f"{100.0 * part.share:.0f} % of output {part.output}" for part in parts])
    cancels = "".join(f"; their effects in {_cancelled(kind)} cancel" for kind in kinds)
    return f"The elevator is {made} ({why}){cancels}."


def _cancelled(kind: str) -> str:
    """Return the axes in which the members of a pair cancel, in words."""
    rows = [row for row in ROWS if row.surface == kind]
    return listed([axis for control, axis in _AXES.items() if any(row.weight(control) for row in rows)])


def _why(kinds: Sequence[str], wiring: Wiring) -> str:
    return listed([f"{kind} pair" for kind in kinds]) or wiring.assumed or wiring.words.elevator


def _one_sided(halves: Collection[Role]) -> list[str]:
    kinds = sorted({half.surface for half in halves})
    return [k for k in kinds if not sides_of(k, "elevator") <= {h.side for h in halves if h.surface == k}]


def _nothing_found(wiring: Wiring) -> Problem:
    words = wiring.words
    mixed = [n for n in wiring.roles if _is_half(n, wiring)]
    if mixed:
        kinds = listed(sorted({wiring.roles[n].surface for n in mixed}))
        return Problem(
            "no_elevator",
            f"Output {joined_numbers(mixed)} is one side of a {kinds} pair without the other.",
            f"Record all {words.function}, or list the elevator's outputs in elevator.outputs.",
        )
    passing = [f"output {n} passes radio channel {k} through" for n, k in sorted(wiring.passed.items())]
    passed = f"; {listed(passing)}" if passing else ""
    if wiring.roles:
        return Problem(
            "no_elevator",
            f"No output has {words.elevator} (elevator), nor an elevon or V-tail pair{passed}.",
            "Set elevator.output and elevator.calibration, or elevator.outputs, in the aircraft file.",
        )
    return Problem(
        "no_elevator",
        words.unknown,
        f"Set elevator.output in the aircraft file ({words.usual}; several: elevator.outputs), "
        "or record the parameters.",
    )


def _numbers(parts: Sequence[Part]) -> tuple[int, ...]:
    return tuple(part.output for part in parts)


def parts_of(control: Control, wiring: Wiring) -> tuple[Part, ...]:
    """Return the outputs of a control in rising order; empty if no set of outputs drives the whole control.

    A control consists of all plain outputs and of each mixed pair with all its members. The control's
    deflection is the mean of its parts. Several outputs of one member are averaged.
    """
    groups: dict[str, dict[int, Role]] = {}
    for n, role in wiring.roles.items():
        if role.weight(control):
            groups.setdefault(role.surface, {})[n] = role
    whole = [mine for surface, mine in groups.items() if _is_whole(surface, mine, control)]
    parts = []
    for mine in whole:
        members = Counter(role.side for role in mine.values())
        for n, role in mine.items():
            share = role.weight(control) / (len(whole) * members[role.side])
            side = f"{role.surface} {role.side}".strip()
            parts.append(Part(n, wiring.scale(n), share, n in wiring.known_directions, side))
    return tuple(sorted(parts, key=lambda part: part.output))


def _is_whole(surface: str, mine: Mapping[int, Role], control: Control) -> bool:
    """Return whether every member of a mixed pair is among the outputs."""
    return sides_of(surface, control) <= {role.side for role in mine.values()}
