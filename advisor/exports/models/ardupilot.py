"""ArduPilot's built-in plane: a model file for ``--model plane:FILE.json``, and parameters of its servo.

The plane of ArduPilot's simulation in the loop reads these keys and leaves its own numbers where a key is
missing. Its conventions, from its source (``libraries/SITL/SIM_Plane``, ``ServoModel``):

- forces are divided by a fixed mass of 2 kg, which no key of the file changes: lift is scaled by 2 kg/m;
- the torque is used as the rotational acceleration, an inertia of 1 kg·m²: moments are divided by I_yy;
- the elevator is a number from -1 to 1, at 1000 and 2000 us: its coefficients are per full travel;
- rates are made dimensionless by c/(2·V), as in ``advisor.oem.coefficients``;
- ``CGOffset`` moves the forces off the centre of gravity: it is zero, as the derivatives are about it.
"""

import json
import math
from collections.abc import Sequence

from advisor.aircraft.controls import Elevator, Pairs
from advisor.exports.models.exported import Exported, commented, effects_beside
from advisor.exports.models.improvement import Improvement
from advisor.words.problems import ConfigurationError

MASS_KG = 2.0
"""Mass of ArduPilot's plane, kg. The frame ``-heavy`` has 8 kg and ``-jet`` 22 kg."""
NEUTRAL_US, HALF_TRAVEL_US = 1500.0, 500.0
SERVO_TRAVEL_DEG = 45.0
"""Deflection that ArduPilot's servo model takes for full travel, deg."""


def model_text(improvement: Improvement) -> Exported:
    """Return the plane's coefficients as JSON with comments.

    Raises
    ------
    ConfigurationError
        Reference data or the elevator's calibration are missing.
    """
    reference = improvement.reference
    neutral, travel = elevator_line(improvement.elevator)
    c = {name: one.value for name, one in improvement.coefficients().items()}
    mass, inertia = reference.mass_kg or math.nan, reference.iyy_kg_m2 or math.nan
    lift, moment = MASS_KG / mass, 1.0 / inertia
    keys = {
        "s": reference.wing_area_m2,
        "c": reference.chord_m,
        "c_lift_0": lift * (c["C_L_0"] + c["C_L_delta_e"] * neutral),
        "c_lift_a": lift * c["C_L_alpha"],
        "c_lift_q": lift * c["C_L_q"],
        "c_lift_deltae": lift * c["C_L_delta_e"] * travel,
        "c_m_0": moment * (c["C_m_0"] + c["C_m_delta_e"] * neutral),
        "c_m_a": moment * c["C_m_alpha"],
        "c_m_q": moment * c["C_m_q"],
        "c_m_deltae": moment * c["C_m_delta_e"] * travel,
        "CGOffset": [0.0, 0.0, 0.0],
    }
    head = [
        f"{improvement.name}: longitudinal coefficients by `advisor gap`. Load: --model plane:THIS-FILE",
        "Merge into your own file: without span, drag, side and roll keys ArduPilot keeps its small plane's.",
        f"c_lift_* are C_L times 2 kg / {mass:.6g} kg: the mass of ArduPilot's plane is 2 kg.",
        "Multiply c_lift_* by 4 for the frame -heavy (8 kg), by 11 for -jet (22 kg).",
        f"c_m_* are C_m divided by I_yy = {inertia:.6g} kg m2: ArduPilot takes the torque as acceleration.",
        f"c_*_deltae are per 500 us of pulse width, {math.degrees(travel):+.4g} deg here.",
        improvement.density_note,
        "C_L and C_m per radian: " + ", ".join(f"{name} {value:.6g}" for name, value in c.items()) + ".",
    ]
    rounded = {k: float(f"{v:.6g}") if isinstance(v, float) else v for k, v in keys.items()}
    left = (*improvement.servo.lines(), *effects_beside(improvement))
    return Exported(commented(head, "#") + json.dumps(rounded, indent=1) + "\n", left)


def servo_text(improvement: Improvement) -> Exported:
    """Return parameters of ArduPilot's servo model, one on each line.

    Alone, ``SIM_SERVO_SPEED`` is the time constant of a first-order lag. With a delay or a filter, it becomes
    a rate limit. The lag then becomes a Butterworth filter of two poles with an equal delay of a ramp.
    """
    servo = improvement.servo
    lag_s = max(servo.lag_s, 0.0)
    speed, delay, cutoff = lag_s, servo.delay_s, 0.0
    if delay > 0.0 or servo.rate_rad_s or servo.damping:
        speed = 0.0
        cutoff = math.sqrt(2.0) / (2.0 * math.pi * lag_s) if lag_s > 0.0 else 0.0
    if servo.rate_rad_s:
        _, travel = elevator_line(improvement.elevator)
        speed = 60.0 * abs(travel) / (SERVO_TRAVEL_DEG * servo.rate_rad_s)
        # Without a delay or filter, the speed would be read as a lag. One step is the least delay.
        delay = delay if delay > 0.0 or cutoff > 0.0 else 0.001
    head = [
        f"{improvement.name}: the elevator's servo by `advisor gap`, for ArduPilot's simulation.",
        "ArduPilot's model is the same for every servo of the aircraft.",
        "Found: " + (", ".join(servo.lines()) or "a servo that follows at once") + ".",
    ]
    values = {"SIM_SERVO_SPEED": speed, "SIM_SERVO_DELAY": delay, "SIM_SERVO_FILTER": cutoff}
    lines = "".join(f"{name} {value:.6g}\n" for name, value in values.items())
    slack = {"actuator backlash": servo.play_rad, "actuator deadband": servo.deadband_rad}
    left = tuple(name for name, size in slack.items() if size)
    return Exported(commented(head, "#") + lines, (*left, *effects_beside(improvement)))


def elevator_line(elevator: Elevator) -> tuple[float, float]:
    """Return the deflection at 1500 us, and its change per 500 us, rad, by the line through the calibration's
    ends.

    Raises
    ------
    ConfigurationError
        The aircraft file has no calibration.
    """
    parts: list[tuple[float, Pairs]] = [(o.weight, o.calibration) for o in elevator.outputs if o.calibration]
    if elevator.calibration:
        parts = [(1.0, elevator.calibration)]
    return line_of(parts, "elevator")


def line_of(parts: Sequence[tuple[float, Pairs]], control: str) -> tuple[float, float]:
    """Return the deflection at 1500 us, and its change per 500 us, rad, of weighted calibrations.

    Raises
    ------
    ConfigurationError
        There is no calibration; the message names that of ``control``.
    """
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
    return math.radians(neutral), math.radians(travel)
