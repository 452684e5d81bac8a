"""From a manoeuvre and the aircraft file to the estimator's record."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft import Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.flight.record import Channel
from advisor.oem.estimate import NoEstimate
from advisor.oem.problem import GRAVITY, Problem, Record, Signal
from advisor.oem.surface import Servo

FEWEST_SAMPLES = 20
SPEED_CHANGE = 0.03
"""Beyond this relative change of air speed the derivatives are scaled with it."""


def prepare(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Problem | NoEstimate:
    """Collect what the estimator needs, or say why it cannot begin."""
    records = []
    for maneuver in maneuvers:
        missing = _missing(maneuver)
        if missing is not None:
            return missing
        records.append(_record(maneuver))
    return Problem(
        records=tuple(records),
        reference_airspeed_m_s=_reference(records, aircraft),
        servo=Servo(aircraft.elevator.lag_s or 0.0, aircraft.elevator.delay_s or 0.0),
        vane_arm_m=aircraft.alpha.vane_arm_m or 0.0,
        accelerometer_arm_m=aircraft.accelerometer.arm_m or 0.0,
    )


def _missing(maneuver: Maneuver) -> NoEstimate | None:
    for name, spoken in (("elevator", "the elevator"), ("alpha", "angle of attack"), ("q", "pitch rate")):
        samples = len(maneuver.channels[name]) if name in maneuver.channels else 0
        if samples < FEWEST_SAMPLES:
            text = (
                f"Manoeuvre {maneuver.number} has {samples} samples of {spoken}; it takes {FEWEST_SAMPLES}."
            )
            return NoEstimate("too_few_samples", text)
    if float(np.ptp(maneuver.channels["elevator"].y)) == 0.0:
        return NoEstimate("no_input", f"The elevator did not move in manoeuvre {maneuver.number}.")
    return None


def _record(maneuver: Maneuver) -> Record:
    channels = maneuver.channels
    outputs = {name: _signal(channels[name]) for name in ("alpha", "q")}
    airspeed = channels.get("airspeed")
    return Record(
        elevator=_signal(channels["elevator"]),
        outputs=outputs,
        airspeed=_signal(airspeed) if airspeed is not None and len(airspeed) > 1 else None,
    )


def _reference(records: Sequence[Record], aircraft: Aircraft) -> float | None:
    """Reference air speed, when the speed is measured and moves enough to matter."""
    if any(record.airspeed is None for record in records):
        return None
    speeds = np.concatenate([record.airspeed.y for record in records if record.airspeed is not None])
    mean = float(np.mean(speeds))
    reference = aircraft.reference_airspeed_m_s or mean
    if np.min(speeds) <= 0.0 or float(np.max(np.abs(speeds / reference - 1.0))) < SPEED_CHANGE / 2.0:
        return None
    return reference


def _signal(channel: Channel) -> Signal:
    return Signal(np.asarray(channel.t, float), np.asarray(channel.y, float))


__all__ = ["GRAVITY", "prepare"]
