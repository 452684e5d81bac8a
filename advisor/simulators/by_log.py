"""A simulator of which only a log exists. A model identified from the log replaces the simulator."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.diagnose import examine
from advisor.gap.result import Diagnosis, spelled
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.mavlink.logs.formats import ENDINGS
from advisor.simulators.interface import interface_fault
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Replay
from advisor.words.problems import ConfigurationError, UnusableInputError
from advisor.words.quantities import NORMAL_95

_LEAST = 2
"""Least number of manoeuvres in a simulator's log. A single manoeuvre identifies no effect, because nothing
remains for a hold-out."""
_MOTION = ("alpha", "theta", "a_z", "airspeed")
_SUFFIXES = (*ENDINGS, ".csv", ".txt", ".tsv", ".mat")


@dataclass(frozen=True)
class IdentifiedSimulator(LinearSimulator):
    """Short-period model and effects identified from a simulator's log, in place of the simulator."""

    as_file: Aircraft = field(default_factory=Aircraft)
    """Aircraft file with the identified model, servo and effects."""
    notes: tuple[str, ...] = ()
    """Sentences about the identified model and effects, with standard deviations."""


def from_log(
    path: Path, aircraft: Aircraft, read_log: Callable[[Path], list[Maneuver]]
) -> IdentifiedSimulator:
    """Identify a simulator by a diagnosis of its log that begins without a model.

    Raises
    ------
    ConfigurationError
        The file does not exist, or is no log.
    UnusableInputError
        The log has no usable elevator manoeuvres.
    """
    if path.suffix.lower() not in _SUFFIXES:
        raise ConfigurationError(
            f"--simulator log:{path}: a log ends with {', '.join(_SUFFIXES)}; name such a file."
        )
    if not path.is_file():
        raise UnusableInputError("no_such_file", f"There is no file {path}.", "Name the simulator's log.")
    servo = replace(aircraft.elevator, lag_s=None, delay_s=None)
    unknown = replace(
        aircraft, model={}, effects={}, elevator=servo, airspeed_m_s=None, reference_airspeed_m_s=None
    )
    maneuvers = read_log(path)
    if len(maneuvers) < _LEAST:
        raise UnusableInputError(
            "simulator_log",
            f"The simulator's log {path.name} holds {len(maneuvers)} elevator manoeuvres; two are needed.",
            "Fly the inputs of the flight in the simulator, too, and log them.",
        )
    said = f"the simulator that wrote {path.name}"
    for maneuver in maneuvers:
        replay = _as_replay(maneuver)
        fault = interface_fault(replay) if replay is not None else None
        if fault is not None:
            raise fault.refuse(said)
    diagnosis = examine(maneuvers, unknown).diagnosis
    effects = {effect: dict(sizes) for effect, sizes in diagnosis.effects.items()}
    lag = effects.pop("actuator_lag", None) if set(effects.get("actuator_lag", ())) == {"lag_s"} else None
    delay = effects.pop("transport_delay", None)
    servo = replace(servo, lag_s=lag["lag_s"] if lag else None, delay_s=delay["delay_s"] if delay else None)
    derivatives = {name: diagnosis.model[name].value for name in DERIVATIVES}
    as_file = replace(
        aircraft, model=derivatives, effects=effects, elevator=servo,
        reference_airspeed_m_s=diagnosis.reference_airspeed_m_s or aircraft.reference_airspeed_m_s,
    )  # fmt: skip
    return IdentifiedSimulator(
        derivatives, as_file.reference_airspeed_m_s, said,
        as_file=as_file, notes=_identified(path.name, diagnosis, maneuvers),
    )  # fmt: skip


def _as_replay(maneuver: Maneuver) -> Replay | None:
    """Return the logged motion at the stamps of the pitch rate; None if a quantity is missing."""
    channels = maneuver.channels
    if not {"q", *_MOTION} <= channels.keys():
        return None
    t = channels["q"].t
    alpha, theta, a_z, airspeed = (np.interp(t, channels[n].t, channels[n].y) for n in _MOTION)
    return Replay(t - t[0], alpha, channels["q"].y, theta, a_z, airspeed, np.zeros(t.size))


def _identified(name: str, diagnosis: Diagnosis, maneuvers: Sequence[Maneuver]) -> tuple[str, ...]:
    numbers = ", ".join(
        f"{n} {diagnosis.model[n].value:.3g} ± {NORMAL_95 * diagnosis.model[n].std:.2g}" for n in DERIVATIVES
    )
    notes = [f"Of the simulator, {len(maneuvers)} manoeuvres in {name} show {numbers}."]
    for cause in (c for c in diagnosis.causes if c.present):
        sizes = ", ".join(f"{n} {v.value:.3g} ± {NORMAL_95 * v.std:.2g}" for n, v in cause.parameters.items())
        notes.append(f"The simulator has {spelled(cause.effect)} of its own: {sizes}.")
    return tuple(notes)
