"""Parameters of ArduPilot's simulated servos: outputs, directions, ends, lag, delay and rate."""

import math
from collections.abc import Iterator

from advisor.exports.models.ardupilot.travel import FUNCTIONS, OUTPUTS, calibrated, travel_of
from advisor.exports.models.exported import Exported, commented, effects_beside
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.servo import ExportedServo

SERVO_TRAVEL_DEG = 45.0
"""Deflection that ArduPilot's servo model takes for full travel, deg."""
_RIGHT = {"elevator": "M_delta_e", "aileron": "L_delta_a", "rudder": "N_delta_r"}
"""Control to the derivative that tells its direction."""


def parameters_text(model: FlownModel) -> Exported:
    """Return parameters of ArduPilot's servos, one on each line."""
    servos = _servos(model)
    control, servo = next(iter(servos.items()), ("elevator", ExportedServo()))
    head = [
        f"{model.name}: servos by the inflight advisor, for ArduPilot's simulation.",
        "ArduPilot's plane reads aileron, elevator and rudder from outputs 1, 2 and 4.",
        f"Lag, delay and rate are the {control}'s: ArduPilot's model is the same for every servo.",
        *(f"{name}: {', '.join(one.lines()) or 'follows at once'}." for name, one in servos.items()),
    ]
    lines = "".join(
        f"{name} {value:.6g}\n" for name, value in (*_outputs(model), *_motion(servo, model, control))
    )
    slack = {"actuator backlash": servo.play_rad, "actuator deadband": servo.deadband_rad}
    left = [name for name, size in slack.items() if size]
    left += [
        f"{name}: {', '.join(one.lines())}" for name, one in servos.items() if one != servo and one.lines()
    ]
    effects = effects_beside(model.pitch) if model.pitch is not None else ()
    return Exported(commented(head, "#") + lines, (*left, *effects))


def _servos(model: FlownModel) -> dict[str, ExportedServo]:
    """Return the servo of each control that is known, the elevator's first."""
    pitch = {"elevator": model.pitch.servo} if model.pitch is not None else {}
    return pitch | (dict(model.side.servos) if model.side is not None else {})


def _outputs(model: FlownModel) -> Iterator[tuple[str, float]]:
    """Yield function, direction and ends of each output with a calibration."""
    known = {n: v.value for n, v in (model.pitch.model if model.pitch is not None else {}).items()}
    if model.side is not None:
        known |= {n: v.value for n, v in model.side.values.items()}
    for control in calibrated(model.aircraft):
        travel, output = travel_of(model.aircraft, control), OUTPUTS[control]
        yield f"SERVO{output}_FUNCTION", FUNCTIONS[control]
        # ArduPilot lengthens the pulse for nose up, roll to the right and nose right, unless it is reversed.
        power = known.get(_RIGHT[control], -1.0) * travel.per_half_rad
        yield f"SERVO{output}_REVERSED", float(power < 0.0)
        yield f"SERVO{output}_MIN", travel.low_us
        yield f"SERVO{output}_TRIM", round(travel.trim_us)
        yield f"SERVO{output}_MAX", travel.high_us


def _motion(servo: ExportedServo, model: FlownModel, control: str) -> Iterator[tuple[str, float]]:
    """Yield lag, delay and rate.

    Alone, ``SIM_SERVO_SPEED`` is the time constant of a first-order lag. With a delay or a filter, it becomes
    a rate limit. The lag then becomes a Butterworth filter of two poles with an equal delay of a ramp.
    """
    lag_s = max(servo.lag_s, 0.0)
    speed, delay, cutoff = lag_s, servo.delay_s, 0.0
    if delay > 0.0 or servo.rate_rad_s or servo.damping:
        speed = 0.0
        cutoff = math.sqrt(2.0) / (2.0 * math.pi * lag_s) if lag_s > 0.0 else 0.0
    if servo.rate_rad_s:
        travel = travel_of(model.aircraft, control).per_half_rad
        speed = 60.0 * abs(travel) / (SERVO_TRAVEL_DEG * servo.rate_rad_s)
        # Without a delay or filter, the speed would be read as a lag. One step is the least delay.
        delay = delay if delay > 0.0 or cutoff > 0.0 else 0.001
    yield from {"SIM_SERVO_SPEED": speed, "SIM_SERVO_DELAY": delay, "SIM_SERVO_FILTER": cutoff}.items()
