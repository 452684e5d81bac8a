"""From servo outputs to surfaces: which output drives the elevator, and what a pulse width means.

The deflection is that of the *command*; what the servo makes of it is the estimator's business.

Signs: an ArduPilot output that is not reversed rises with the demand, and a positive pitch
demand lifts the nose; so more PWM is trailing edge up unless SERVOn_REVERSED is set. The
elevator channel counts trailing edge down as positive, hence the minus in `Scale.deflection`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from advisor.aircraft import Elevator
from advisor.flight.messages import FloatArray
from advisor.problems import Problem

# Values of SERVOn_FUNCTION, ArduPilot's SRV_Channel.h.
AILERON, ELEVATOR, RUDDER = 4, 19, 21
_MIXED = {77: "elevon", 78: "elevon", 79: "V-tail", 80: "V-tail"}
_FULL_STROKE_RAD = np.radians(25.0)
_UNUSED_PX4 = 900.0

Parameters = Mapping[str, float]
"""PARAM_VALUEs of the vehicle by name."""


@dataclass(frozen=True, slots=True)
class Scale:
    """SERVOn_MIN/TRIM/MAX/REVERSED of one output, taken as full strokes of 25 degrees."""

    low_us: float = 1100.0
    trim_us: float = 1500.0
    high_us: float = 1900.0
    reversed: bool = False

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Surface angle in rad, trailing edge down positive, clipped at the ends."""
        up = np.interp(pwm_us, [self.low_us, self.trim_us, self.high_us], [-1.0, 0.0, 1.0])
        return np.asarray((_FULL_STROKE_RAD if self.reversed else -_FULL_STROKE_RAD) * up)


@dataclass(frozen=True, slots=True)
class Calibration:
    """Pairs (PWM in us, deflection in deg) of the aircraft file, linear between, none beyond."""

    pairs: tuple[tuple[float, float], ...]

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Surface angle in rad, trailing edge down positive, held at the last pair beyond the ends."""
        pwm, deg = zip(*sorted(self.pairs), strict=True)
        return np.asarray(np.radians(np.interp(pwm_us, pwm, deg)))


@dataclass(frozen=True, slots=True)
class Surface:
    """One control surface: the output or outputs that drive it, and their scales."""

    outputs: tuple[int, ...]
    """Servo outputs 1..32; two for elevons, a V-tail, or a split elevator: their mean counts."""
    scales: tuple[Scale | Calibration, ...]
    calibrated: bool
    """False when the scale is SERVOn_MIN/TRIM/MAX and an assumed 25 deg."""
    said: str
    """What the user should know about this mapping."""

    @property
    def port(self) -> int:
        """SERVO_OUTPUT_RAW.port of the bank of 16 that holds the outputs."""
        return (self.outputs[0] - 1) // 16

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Mean surface angle in rad from pulses of shape (n, number of outputs)."""
        angles = [scale.deflection(pwm_us[:, k]) for k, scale in enumerate(self.scales)]
        return np.asarray(np.mean(angles, axis=0))


def driven(pwm_us: FloatArray, autopilot: str) -> NDArray[np.bool_]:
    """Rows in which every output carries a pulse: 0 and 65535 mean none, on PX4 900 too."""
    alive = (pwm_us > 0) & (pwm_us < 65535)
    if autopilot == "px4":
        alive &= pwm_us != _UNUSED_PX4
    return np.asarray(np.all(alive, axis=1))


def find_elevator(elevator: Elevator, parameters: Parameters) -> Surface | Problem:
    """Which output is the elevator, and its scale.

    Parameters
    ----------
    elevator
        As the aircraft file has it.
    parameters
        What is known of SERVOn_*; may be empty.
    """
    functions = _functions(parameters)
    if elevator.output != "auto":
        given = _surface((elevator.output,), elevator, parameters, "as the aircraft file says")
        mixed = _MIXED.get(functions.get(elevator.output, 0))
        if mixed and elevator.calibration is None:
            return Problem(
                "no_elevator",
                f"Output {elevator.output} is one half of a mixed {mixed} pair, not an elevator.",
                "Set elevator.output to auto: both halves are then read together.",
            )
        return replace(given, said=_half_of(elevator.output, mixed)) if mixed else given
    found = tuple(n for n, function in functions.items() if function == ELEVATOR)
    halves = tuple(n for n, function in functions.items() if function in _MIXED)
    outputs = found or halves
    if not outputs:
        return _nothing_found(bool(functions))
    if halves and not found and len(halves) != 2:
        return Problem(
            "no_elevator",
            f"Outputs {_listed(halves)} are mixed elevons or V-tail halves, and only pairs are understood.",
            "Set elevator.output to the output of a plain elevator.",
        )
    if len({(n - 1) // 16 for n in outputs}) > 1:
        return Problem(
            "no_elevator",
            f"The elevator's outputs {_listed(outputs)} come in separate messages, by banks of 16.",
            "Set elevator.output to one of them.",
        )
    if elevator.calibration is not None and len(outputs) > 1:
        return Problem(
            "no_elevator",
            f"elevator.calibration describes one output, but outputs {_listed(outputs)} act together.",
            "Leave elevator.calibration out, or set elevator.output to one plain output.",
        )
    kind = _MIXED[functions[halves[0]]] + " pair" if halves and not found else "SERVOn_FUNCTION 19"
    return _surface(outputs, elevator, parameters, kind)


def find_surface(function: int, parameters: Parameters) -> Surface | None:
    """The outputs of any other function, e.g. ``AILERON``; None when no parameter says."""
    outputs = tuple(n for n, value in _functions(parameters).items() if value == function)
    if not outputs or len({(n - 1) // 16 for n in outputs}) > 1:
        return None
    return _surface(outputs, Elevator(), parameters, "")


def _surface(outputs: tuple[int, ...], elevator: Elevator, parameters: Parameters, why: str) -> Surface:
    if elevator.calibration is not None:
        return Surface(outputs, (Calibration(elevator.calibration),), True, "")
    said = (
        f"No elevator.calibration: output {_listed(outputs)} ({why}) is scaled by SERVOn_MIN/TRIM/MAX "
        "as full strokes of 25 deg, so Z_delta_e and M_delta_e are per assumed degree."
    )
    return Surface(outputs, tuple(_scale(n, parameters) for n in outputs), False, said)


def _half_of(output: int, mixed: str) -> str:
    return (
        f"Output {output} is one half of a mixed {mixed} pair, calibrated as an elevator in the aircraft "
        "file: what it does for the other axis counts as elevator, too."
    )


def _scale(n: int, parameters: Parameters) -> Scale:
    default = Scale()
    return Scale(
        low_us=parameters.get(f"SERVO{n}_MIN", default.low_us),
        trim_us=parameters.get(f"SERVO{n}_TRIM", default.trim_us),
        high_us=parameters.get(f"SERVO{n}_MAX", default.high_us),
        reversed=bool(parameters.get(f"SERVO{n}_REVERSED", 0.0)),
    )


def _functions(parameters: Parameters) -> dict[int, int]:
    outputs = {n: parameters.get(f"SERVO{n}_FUNCTION") for n in range(1, 33)}
    return {n: int(value) for n, value in outputs.items() if value is not None}


def _nothing_found(functions_known: bool) -> Problem:
    if functions_known:
        return Problem(
            "no_elevator",
            "No output has SERVOn_FUNCTION 19 (elevator), nor an elevon or V-tail pair.",
            "Set elevator.output and elevator.calibration in the aircraft file.",
        )
    return Problem(
        "no_elevator",
        "Nothing says which servo output is the elevator: no SERVOn_FUNCTION was received.",
        "Set elevator.output in the aircraft file (on most ArduPlane aircraft 2), or record the parameters.",
    )


def _listed(outputs: tuple[int, ...]) -> str:
    return " and ".join(str(n) for n in outputs)
