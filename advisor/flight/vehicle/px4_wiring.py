"""Roles and scales of servo outputs from PX4's parameters: CA_SV_CSn_* for surfaces, PWM_MAIN_* for outputs.

Surface ``n`` belongs to servo ``n``, counted from 0. An output whose function is 201 + n drives that servo. A
positive elevator command raises the nose if its torque effectiveness CA_SV_CSn_TRQ_P is positive. (PX4 since
1.13: ActuatorEffectivenessControlSurfaces.hpp, mixer_module.cpp.)
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import copysign

import numpy as np

from advisor.flight.vehicle.mixers import ELEVATOR, NOTHING, PX4, Control, Role, Torque
from advisor.flight.vehicle.surfaces import Parameters, Scale, Wiring, Words, assumed_limits

GROUPS = {
    "PWM_MAIN": Scale(1000.0, 1500.0, 2000.0),
    "PWM_AUX": Scale(1000.0, 1500.0, 2000.0),
    "UAVCAN_SV": Scale(0.0, 500.0, 1000.0),
    "SIM_GZ_SV": Scale(0.0, 500.0, 1000.0),
    "HIL_ACT": Scale(1000.0, 1500.0, 2000.0),
}
"""Default limits of each group of outputs, by the beginning of its parameters' names."""
FOLLOWS_PITCH = "READER_PITCH"
"""``READER_PITCHn`` is 1 or -1 if a log reader found that output n follows the pitch command or its opposite.
PX4 before 1.13 mixes its outputs by files, which no log contains."""
STANDS_FOR_ELEVATOR = 2.0
"""Value of ``READER_PITCHn`` if the pulses are the pitch command itself, with 500 us for full command."""
PREFIXES = ("CA_SV_CS", *GROUPS, FOLLOWS_PITCH)
"""Beginnings of the names of PX4's parameters about servo outputs."""
OUTPUTS = range(1, 17)
"""Numbers of the outputs of one group."""
_SURFACES = range(8)
_SERVO_1 = 201
"""Output function number of servo 0. Functions 101 to 112 belong to motors."""
_SERVOS = range(16)
_CUSTOM = 12
_AXES: Mapping[Control, int] = {"aileron": 0, "elevator": 1, "rudder": 2}
"""Index of each control's torque in roll, pitch and yaw."""

WORDS = Words(
    function="CA_SV_CSn_TYPE",
    elevator="CA_SV_CSn_TYPE 3",
    limits="PWM_MAIN_MINn/MAXn",
    trim="the middle of PWM_MAIN_MINn and MAXn",
    sense="CA_SV_CSn_TRQ_P and PWM_MAIN_REV of output {n}",
    unknown="The elevator's servo output is unknown: no CA_SV_CSn_TYPE was received, and no output follows "
    "a pitch command.",
    usual="its place in actuator_outputs, from 1",
)


@dataclass(frozen=True, slots=True)
class ServoOutput:
    """Servo output that drives a servo."""

    number: int
    """Number of the output, from 1 over all groups in use, with 16 outputs per group."""
    servo: int
    """Number of the servo that the output drives, counted from 0."""
    scale: Scale
    """Limits and direction of the output, independent of the surface."""


def banks(parameters: Parameters) -> list[str]:
    """Return the groups that have an output with a function. Outputs 1 to 16 belong to the first group, and
    17 to 32 to the next group."""
    return [group for group in GROUPS if any(parameters.get(f"{group}_FUNC{k}", 0.0) for k in OUTPUTS)]


def servo_outputs(parameters: Parameters) -> list[ServoOutput]:
    """Return the first output of each servo. Without a known function, servo n is at output n + 1."""
    outputs: dict[int, ServoOutput] = {}
    for bank, group in enumerate(banks(parameters)):
        for k in OUTPUTS:
            servo = int(parameters.get(f"{group}_FUNC{k}", 0.0)) - _SERVO_1
            if servo in _SERVOS:
                output = ServoOutput(16 * bank + k, servo, _scale(group, k, parameters))
                outputs.setdefault(servo, output)
    if not banks(parameters):
        outputs = {servo: ServoOutput(servo + 1, servo, GROUPS["PWM_MAIN"]) for servo in _SERVOS}
    return list(outputs.values())


def px4_wiring(parameters: Parameters) -> Wiring:
    """Return the wiring of the outputs from the surfaces they drive, else from a log reader's findings."""
    surfaces = {n: (role, _torque(n, kind, parameters)) for n, kind, role in _surfaces(parameters)}
    if not surfaces:
        return _followers(parameters)
    carried = [output for output in servo_outputs(parameters) if output.servo in surfaces]
    stated = _stated_limits(parameters)
    return Wiring(
        WORDS,
        {output.number: _signed(*surfaces[output.servo]) for output in carried},
        {output.number: _turned(output.scale, *surfaces[output.servo]) for output in carried},
        frozenset(output.number for output in carried if _stated_torque(output.servo, parameters)[1]),
        doubts={
            output.number: assumed_limits(output.number, output.scale)
            for output in carried
            if output.number not in stated
        },
    )


def allocation(parameters: Parameters) -> dict[int, Torque]:
    """Return each servo's command per unit torque demand in roll, pitch and yaw.

    The commands are the pseudo-inverse of the torque matrix. An unstated torque is PX4's default: one over
    the number of surfaces with an effect about the axis.
    """
    surfaces = {n: _torque(n, kind, parameters) for n, kind, _ in _surfaces(parameters)}
    given = {n: _stated_torque(n, parameters) for n in surfaces}
    effect = np.array([*surfaces.values()], dtype=np.float64).reshape(-1, 3)
    shares = np.maximum(np.count_nonzero(effect, axis=0), 1)
    unstated = np.array([*given.values()], dtype=np.float64).reshape(-1, 3) == 0.0
    commands = np.linalg.pinv(np.where(unstated, effect / shares, effect).T)
    return {n: (row[0], row[1], row[2]) for n, row in zip(surfaces, commands.tolist(), strict=True)}


def _stated_limits(parameters: Parameters) -> frozenset[int]:
    return frozenset(
        16 * bank + k
        for bank, group in enumerate(banks(parameters))
        for k in OUTPUTS
        if {f"{group}_MIN{k}", f"{group}_MAX{k}"} <= parameters.keys()
    )


def _surfaces(parameters: Parameters) -> Iterator[tuple[int, int, Role]]:
    """Yield the servo, the kind and the role of each surface that is in use."""
    count = int(parameters.get("CA_SV_CS_COUNT", len(_SURFACES)))
    for n in _SURFACES:
        kind = int(parameters.get(f"CA_SV_CS{n}_TYPE", 0.0))
        if n < count and kind:
            roll, pitch, yaw = _stated_torque(n, parameters)
            pitches_alone = kind == _CUSTOM and pitch and not roll and not yaw
            yield n, kind, ELEVATOR if pitches_alone else PX4.get(kind, (NOTHING,))[0]


def _stated_torque(n: int, parameters: Parameters) -> Torque:
    """Return the torque of surface ``n`` in roll, pitch and yaw; 0 if unknown."""
    roll, pitch, yaw = (parameters.get(f"CA_SV_CS{n}_TRQ_{axis}", 0.0) for axis in "RPY")
    return roll, pitch, yaw


def _torque(n: int, kind: int, parameters: Parameters) -> Torque:
    """Return the torque of surface ``n``; an unstated one is the usual torque of its kind."""
    usual = PX4.get(kind, (NOTHING, (0.0, 0.0, 0.0)))[1]
    roll, pitch, yaw = (own or other for own, other in zip(_stated_torque(n, parameters), usual, strict=True))
    return roll, pitch, yaw


def _main_torque(role: Role, torque: Torque) -> float:
    """Return the torque about a surface's main axis: pitch for a mixed surface."""
    mains: tuple[Control, ...] = ("elevator", "aileron", "rudder")
    return next((torque[_AXES[control]] for control in mains if role.weight(control)), 0.0)


def _turned(scale: Scale, role: Role, torque: Torque) -> Scale:
    """Return the scale of an output, reversed if its surface has a negative torque about its main axis."""
    return replace(scale, reversed=scale.reversed != (_main_torque(role, torque) < 0.0))


def _signed(role: Role, torque: Torque) -> Role:
    """Return a mixed surface's role with the signs of its torque, on the scale of its main axis."""
    if not role.is_mixed:
        return role
    main = _main_torque(role, torque)
    aileron, elevator, rudder = (
        copysign(role.weight(control), torque[axis] * main) for control, axis in _AXES.items()
    )
    return replace(role, aileron=aileron, elevator=elevator, rudder=rudder)


def _scale(group: str, k: int, parameters: Parameters) -> Scale:
    default = GROUPS[group]
    ends = sorted(
        parameters.get(f"{group}_{end}{k}", usual)
        for end, usual in (("MIN", default.low_us), ("MAX", default.high_us))
    )
    centre = parameters.get(f"{group}_CENT{k}", -1.0)
    trim = centre if ends[0] < centre < ends[1] else 0.5 * sum(ends)
    return Scale(ends[0], trim, ends[1], bool(int(parameters.get(f"{group}_REV", 0.0)) >> (k - 1) & 1))


def _followers(parameters: Parameters) -> Wiring:
    numbered = ((n, parameters.get(f"{FOLLOWS_PITCH}{n}")) for n in range(1, 49))
    senses = {n: sense for n, sense in numbered if sense is not None}
    assumed = ""
    if senses:
        assumed = "a guess, because this output follows the pitch command"
    if STANDS_FOR_ELEVATOR in senses.values():
        assumed = "the pitch command, which replaces the elevator"
    return Wiring(
        WORDS,
        dict.fromkeys(senses, ELEVATOR),
        {n: replace(GROUPS["PWM_MAIN"], reversed=sense < 0.0) for n, sense in senses.items()},
        frozenset(senses),
        assumed,
    )
