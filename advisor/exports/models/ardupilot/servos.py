"""Parameters of ArduPilot's simulated servos: outputs, directions, ends, lag, delay and rate.

ArduPilot's simulated surfaces are numbers from -1 to 1, at 1000 and 2000 us. Coefficients of a control are
therefore per 500 us, with the sign of the calibration.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Pairs
from advisor.exports.models.exported import Exported, commented, effects_beside
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.improvement import ExportedServo
from advisor.model.axes.lateral import LATERAL
from advisor.words.problems import ConfigurationError

NEUTRAL_US, HALF_TRAVEL_US = 1500.0, 500.0
OUTPUTS = {"aileron": 1, "elevator": 2, "rudder": 4}
"""Servo output from which ArduPilot's plane reads each control."""
FUNCTIONS = {"aileron": 4, "elevator": 19, "rudder": 21}
"""Value of SERVOn_FUNCTION for each control."""


@dataclass(frozen=True)
class Travel:
    """Straight line through the end points of a calibration."""

    neutral_rad: float
    """Deflection at 1500 us, rad."""
    per_half_rad: float
    """Change of the deflection per 500 us, rad."""
    low_us: float
    high_us: float
    """Pulse widths at both ends of the calibration, us."""

    @property
    def trim_us(self) -> float:
        """Pulse width at zero deflection, within the ends, us."""
        at = NEUTRAL_US - HALF_TRAVEL_US * self.neutral_rad / self.per_half_rad
        return min(max(at, self.low_us), self.high_us)


def travel_of(aircraft: Aircraft, control: str) -> Travel:
    """Return the travel of the elevator, aileron or rudder.

    Raises
    ------
    ConfigurationError
        The aircraft file has no calibration of this control.
    """
    parts = _calibrations(aircraft, control)
    if not parts:
        raise ConfigurationError(
            f"--export ardupilot: coefficients are per full travel of the servo; give {control}.calibration "
            "in the aircraft file."
        )
    total = sum(weight for weight, _ in parts)
    neutral = travel = 0.0
    for weight, pairs in parts:
        (low_us, low), (high_us, high) = min(pairs), max(pairs)
        slope = (high - low) / (high_us - low_us)
        neutral += weight / total * (low + slope * (NEUTRAL_US - low_us))
        travel += weight / total * slope * HALF_TRAVEL_US
    ends = parts[0][1]
    return Travel(math.radians(neutral), math.radians(travel), min(ends)[0], max(ends)[0])


def calibrated(aircraft: Aircraft) -> list[str]:
    """Return the controls with a calibration in the aircraft file."""
    return [name for name in ("elevator", *LATERAL.inputs) if _calibrations(aircraft, name)]


def _calibrations(aircraft: Aircraft, control: str) -> list[tuple[float, Pairs]]:
    """Return the calibrations of a control's outputs, with their weights."""
    stated = getattr(aircraft, control)
    if stated.calibration:
        return [(1.0, stated.calibration)]
    return [(o.weight, o.calibration) for o in getattr(stated, "outputs", ()) if o.calibration]


SERVO_TRAVEL_DEG = 45.0
"""Deflection for full travel in ArduPilot's servo model, deg."""
_RIGHT = {"elevator": "M_delta_e", "aileron": "L_delta_a", "rudder": "N_delta_r"}
"""Derivative whose sign gives the direction of each control."""


def parameters_text(model: FlownModel) -> Exported:
    """Return parameters of ArduPilot's servos, one on each line."""
    servos = _servos(model)
    control, servo = next(iter(servos.items()), ("elevator", ExportedServo()))
    head = [
        f"{model.name}: servos by the inflight advisor, for ArduPilot's simulation.",
        "ArduPilot's plane reads aileron, elevator and rudder from outputs 1, 2 and 4.",
        f"Lag, delay and rate are the {control}'s: ArduPilot's model is the same for every servo.",
        *(f"{name}: {', '.join(s.lines()) or 'follows at once'}." for name, s in servos.items()),
    ]
    lines = "".join(
        f"{name} {value:.6g}\n" for name, value in (*_outputs(model), *_motion(servo, model, control))
    )
    slack = {"actuator backlash": servo.play_rad, "actuator deadband": servo.deadband_rad}
    left = [name for name, size in slack.items() if size]
    left += [f"{name}: {', '.join(s.lines())}" for name, s in servos.items() if s != servo and s.lines()]
    effects = effects_beside(model.pitch) if model.pitch is not None else ()
    return Exported(commented(head, "#") + lines, (*left, *effects))


def _servos(model: FlownModel) -> dict[str, ExportedServo]:
    """Return the servo of each control with a known model, the elevator's first."""
    pitch = {"elevator": model.pitch.servo} if model.pitch is not None else {}
    return pitch | (dict(model.side.servos) if model.side is not None else {})


def _outputs(model: FlownModel) -> Iterator[tuple[str, float]]:
    """Yield function, direction and end points of each output with a calibration."""
    values = {n: v.value for n, v in (model.pitch.model if model.pitch is not None else {}).items()}
    if model.side is not None:
        values |= {n: v.value for n, v in model.side.values.items()}
    for control in calibrated(model.aircraft):
        travel, output = travel_of(model.aircraft, control), OUTPUTS[control]
        yield f"SERVO{output}_FUNCTION", FUNCTIONS[control]
        # ArduPilot lengthens the pulse for nose up, roll to the right and nose right, unless it is reversed.
        power = values.get(_RIGHT[control], -1.0) * travel.per_half_rad
        yield f"SERVO{output}_REVERSED", float(power < 0.0)
        yield f"SERVO{output}_MIN", travel.low_us
        yield f"SERVO{output}_TRIM", round(travel.trim_us)
        yield f"SERVO{output}_MAX", travel.high_us


def _motion(servo: ExportedServo, model: FlownModel, control: str) -> Iterator[tuple[str, float]]:
    """Yield the parameters of a servo's lag, delay and rate."""
    # Alone, SIM_SERVO_SPEED is a first-order lag's time constant; with a delay or filter, a rate limit.
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
