"""The elevator: which servo outputs make it, how they are mixed, and what the user is told of that.

Elevons, the halves of a V-tail and differential spoilers all follow the pitch demand upwards and the other
demand in opposite directions (ArduPlane, ``servos.cpp``). The mean of the left and the right side is
therefore the elevator, and the other demand cancels.
"""

from collections.abc import Sequence

from advisor.aircraft import Elevator, ElevatorOutput, Pairs
from advisor.flight.surfaces import (
    ELEVATOR,
    Calibration,
    Parameters,
    Part,
    Surface,
    functions_of,
    in_shares,
    joined_numbers,
    listed,
    scale_of,
)
from advisor.problems import Problem

# SERVOn_FUNCTION of mixed outputs, ArduPilot's SRV_Channel.h: what it is, and on which side.
_MIXED = {
    77: ("elevon", "left"),
    78: ("elevon", "right"),
    79: ("V-tail", "left"),
    80: ("V-tail", "right"),
    16: ("differential spoiler", "left"),
    86: ("differential spoiler", "left"),
    17: ("differential spoiler", "right"),
    87: ("differential spoiler", "right"),
}
_CANCELS = {
    "elevon": "what they do in roll cancels",
    "V-tail": "what they do in yaw cancels",
    "differential spoiler": "what they do in roll and yaw cancels",
}
_ASSUMED = (
    "No calibration: they are scaled by SERVOn_MIN/TRIM/MAX as full strokes of 25 deg, so Z_delta_e and "
    "M_delta_e are per assumed degree."
)


def find_elevator(
    elevator: Elevator, parameters: Parameters, why: str = "as the aircraft file says"
) -> Surface | Problem:
    """Which outputs are the elevator, and their scales.

    Parameters
    ----------
    elevator
        As the aircraft file has it.
    parameters
        What is known of SERVOn_*; may be empty.
    why
        Why ``elevator.output`` is what it is, in words.
    """
    if elevator.outputs:
        return _as_listed(elevator.outputs, parameters)
    if elevator.output != "auto":
        return _as_given(elevator.output, elevator.calibration, parameters, why)
    return _as_found(elevator.calibration, parameters)


def _as_listed(outputs: Sequence[ElevatorOutput], parameters: Parameters) -> Surface | Problem:
    if len(outputs) == 1:
        return _as_given(outputs[0].output, outputs[0].calibration, parameters, "as the aircraft file says")
    parts = in_shares(
        Part(
            one.output,
            Calibration(one.calibration) if one.calibration else scale_of(one.output, parameters),
            one.weight,
            one.calibration is not None or _is_told(one.output, parameters),
        )
        for one in outputs
    )
    calibrated = outputs[0].calibration is not None
    sides = {_MIXED[f] for n, f in functions_of(parameters).items() if n in _numbers(parts) and f in _MIXED}
    said = [_formed(parts, "as the aircraft file says", sorted({kind for kind, _ in sides}))]
    said += [
        f"Only one side of the {kind} pair is among them: its other axis counts as elevator, too."
        for kind in _one_sided(sides)
    ]
    return Surface(parts, calibrated, " ".join(said if calibrated else [*said, _ASSUMED]))


def _as_given(output: int, calibration: Pairs | None, parameters: Parameters, why: str) -> Surface | Problem:
    mixed, _ = _MIXED.get(functions_of(parameters).get(output, 0), ("", ""))
    if calibration is None:
        if mixed:
            return Problem(
                "no_elevator",
                f"Output {output} is one half of a mixed {mixed} pair, not an elevator.",
                "Set elevator.output to auto: both halves are then read together. "
                "Or list both in elevator.outputs.",
            )
        return _uncalibrated(Part(output, scale_of(output, parameters)), why)
    said = (
        f"Output {output} is one half of a mixed {mixed} pair, calibrated as an elevator in the aircraft "
        "file: what it does for the other axis counts as elevator, too."
    )
    return Surface((Part(output, Calibration(calibration)),), True, said if mixed else "")


def _as_found(calibration: Pairs | None, parameters: Parameters) -> Surface | Problem:
    functions = functions_of(parameters)
    # Groups of outputs that each make a whole elevator: all with function 19, and all pairs of one kind.
    groups = [[[n for n, function in functions.items() if function == ELEVATOR]]]
    mixed = {n: _MIXED[function] for n, function in functions.items() if function in _MIXED}
    groups += [
        [[n for n, half in mixed.items() if half == (kind, side)] for side in ("left", "right")]
        for kind in dict.fromkeys(kind for kind, _ in mixed.values())
    ]
    whole = [sides for sides in groups if all(sides)]
    if not whole:
        return _nothing_found(functions, mixed)
    parts = in_shares(
        Part(n, scale_of(n, parameters), 1.0 / (len(sides) * len(side)), _is_told(n, parameters))
        for sides in whole
        for side in sides
        for n in side
    )
    kinds = list(dict.fromkeys(mixed[n][0] for n in _numbers(parts) if n in mixed))
    if calibration is not None:
        return _carried_over(calibration, parts, kinds, parameters)
    if len(parts) == 1:
        return _uncalibrated(parts[0], "SERVOn_FUNCTION 19")
    return Surface(parts, False, f"{_formed(parts, _why(kinds), kinds)} {_ASSUMED}")


def _carried_over(
    calibration: Pairs, parts: Sequence[Part], kinds: Sequence[str], parameters: Parameters
) -> Surface | Problem:
    """One calibration for all that was found: that of the first output, carried over to the others."""
    first, *others = _numbers(parts)
    if not others:
        return Surface((Part(first, Calibration(calibration)),), True, "")
    untold = [n for n in (first, *others) if f"SERVO{n}_REVERSED" not in parameters]
    if untold:
        return Problem(
            "no_elevator",
            f"elevator.calibration describes one output, but outputs {joined_numbers((first, *others))} act "
            f"together, and SERVO{untold[0]}_REVERSED is not known.",
            "Give elevator.outputs in place of it, with a calibration for each output.",
        )
    measured = scale_of(first, parameters)
    found = tuple(
        Part(
            part.output,
            Calibration(calibration).carried_over(measured, scale_of(part.output, parameters)),
            part.share,
        )
        for part in parts
    )
    turned = [n for n in others if scale_of(n, parameters).reversed != measured.reversed]
    way = f", the other way round for {joined_numbers(turned)} (SERVOn_REVERSED)" if turned else ""
    said = (
        f"elevator.calibration is taken for output {first} and carried over to {joined_numbers(others)}, "
        f"counted from SERVOn_TRIM{way}; elevator.outputs can hold one for each."
    )
    return Surface(found, True, f"{_formed(found, _why(kinds), kinds)} {said}")


def _uncalibrated(part: Part, why: str) -> Surface:
    said = (
        f"No elevator.calibration: output {part.output} ({why}) is scaled by SERVOn_MIN/TRIM/MAX "
        "as full strokes of 25 deg, so Z_delta_e and M_delta_e are per assumed degree."
    )
    return Surface((part,), False, said)


def _is_told(n: int, parameters: Parameters) -> bool:
    """Whether the parameters say which way a pitch demand moves output ``n``."""
    function = functions_of(parameters).get(n)
    return (function == ELEVATOR or function in _MIXED) and f"SERVO{n}_REVERSED" in parameters


def _formed(parts: Sequence[Part], why: str, kinds: Sequence[str]) -> str:
    """How the outputs make the elevator, in a sentence."""
    shares = [part.share for part in parts]
    if max(shares) - min(shares) < 1e-9:
        made = f"the mean of outputs {joined_numbers(_numbers(parts))}"
    else:
        made = listed([f"{100.0 * part.share:.0f} % of output {part.output}" for part in parts])
    cancels = "".join(f"; {_CANCELS[kind]}" for kind in kinds)
    return f"The elevator is {made} ({why}){cancels}."


def _why(kinds: Sequence[str]) -> str:
    return listed([f"{kind} pair" for kind in kinds]) or "SERVOn_FUNCTION 19"


def _one_sided(sides: set[tuple[str, str]]) -> list[str]:
    kinds = sorted(kind for kind, _ in sides)
    return [kind for kind in kinds if kinds.count(kind) == 1]


def _nothing_found(functions: dict[int, int], mixed: dict[int, tuple[str, str]]) -> Problem:
    if mixed:
        kinds = listed(sorted({kind for kind, _ in mixed.values()}))
        return Problem(
            "no_elevator",
            f"Output {joined_numbers(list(mixed))} is one side of a {kinds} pair without the other.",
            "Record all SERVOn_FUNCTION, or list the elevator's outputs in elevator.outputs.",
        )
    if functions:
        return Problem(
            "no_elevator",
            "No output has SERVOn_FUNCTION 19 (elevator), nor an elevon or V-tail pair.",
            "Set elevator.output and elevator.calibration, or elevator.outputs, in the aircraft file.",
        )
    return Problem(
        "no_elevator",
        "Nothing says which servo output is the elevator: no SERVOn_FUNCTION was received.",
        "Set elevator.output in the aircraft file (on most ArduPlane aircraft 2; several: elevator.outputs), "
        "or record the parameters.",
    )


def _numbers(parts: Sequence[Part]) -> tuple[int, ...]:
    return tuple(part.output for part in parts)
