"""The three commands to run after an examination, with its log or connection and suitable options."""

import shlex
from dataclasses import dataclass

from advisor.doctor.examination import Examination
from advisor.process.installed import SAMPLE

NEW_FILE = "aircraft.yaml"
"""Name of the aircraft file in the commands, if no aircraft file exists."""
RECORDING = "flight.tlog"
"""Name of a live link's recording in the commands."""
USUAL_LINK = "udpin:0.0.0.0:14550"
"""Default address to which ground stations and simulators send telemetry."""
_SLOW = frozenset({"rate", "renewal", "no_pitch_rate", "no_alpha", "no_airspeed", "no_accelerometer"})
"""Codes of limits for which faster message streams are the remedy."""

_NO_AIRCRAFT = frozenset({"no_vehicle", "multicopter"})
"""Codes of limits of a log without a fixed-wing aircraft."""


@dataclass(frozen=True, slots=True)
class ExaminedInput:
    """The log or connection that was examined, as the user named it."""

    target: str
    """Path of a log, or address of a connection."""
    is_log: bool
    aircraft_file: str | None = None
    target_system: int | None = None
    has_model: bool = False
    """Whether the aircraft file has the simulator's derivatives."""


def next_commands(findings: Examination, examined: ExaminedInput) -> tuple[str, str, str]:
    """Return the next three commands, in their order."""
    return _after_log(findings, examined) if examined.is_log else _after_link(findings, examined)


def _after_log(findings: Examination, examined: ExaminedInput) -> tuple[str, str, str]:
    log, aircraft = shlex.quote(examined.target), shlex.quote(examined.aircraft_file or NEW_FILE)
    chosen = _chosen(findings, examined)
    stopping = {limit.code for limit in findings.limits if limit.stops}
    if examined.aircraft_file is None:
        describe = f"advisor aircraft new --from {log} -o {NEW_FILE}{chosen}"
    else:
        describe = f"advisor aircraft check {aircraft} --log {log}{chosen}"
    if not stopping:
        last = "gap" if examined.has_model else "report"
        output = "" if examined.has_model else " -o flight.html"
        return (
            describe,
            f"advisor replay {log} --aircraft {aircraft}{chosen}",
            f"advisor {last} {log} --aircraft {aircraft}{output}{chosen}",
        )
    if stopping & _NO_AIRCRAFT:
        sample = f"{SAMPLE}.tlog --aircraft {SAMPLE}.yaml"
        return (f"advisor doctor {USUAL_LINK}", "advisor sample", f"advisor doctor {sample}")
    if stopping & _SLOW:
        # This flight is lost for the purpose; the next one need not be.
        if examined.aircraft_file is None:
            return (describe, *_next_flight(aircraft)[:2])
        return _next_flight(aircraft)
    return (
        describe,
        f"advisor doctor {log} --aircraft {aircraft}{chosen}",
        f"advisor analyze {log} --aircraft {aircraft} --all{chosen}",
    )


def _next_flight(aircraft: str) -> tuple[str, str, str]:
    return (
        f"advisor doctor {USUAL_LINK} --request-rates --aircraft {aircraft}",
        f"advisor live --master {USUAL_LINK} --request-rates --record {RECORDING} --aircraft {aircraft}",
        f"advisor analyze {RECORDING} --aircraft {aircraft}",
    )


def _after_link(findings: Examination, examined: ExaminedInput) -> tuple[str, str, str]:
    connection, chosen = shlex.quote(examined.target), _chosen(findings, examined)
    aircraft = f" --aircraft {shlex.quote(examined.aircraft_file)}" if examined.aircraft_file else ""
    codes = {limit.code for limit in findings.limits}
    rates = " --request-rates" if codes & _SLOW or findings.elevator is None else ""
    live = f"advisor live --master {connection}{rates} --record {RECORDING}{aircraft}{chosen}"
    after = f"advisor report {RECORDING}{aircraft} -o flight.html{chosen}"
    if any(limit.stops for limit in findings.limits):
        return (f"advisor doctor {connection}{rates}{aircraft}{chosen}", live, after)
    return (live, f"advisor analyze {RECORDING}{aircraft}{chosen}", after)


def _chosen(findings: Examination, examined: ExaminedInput) -> str:
    """Return the option that names the vehicle, if the user selected a vehicle or several vehicles are
    received.
    """
    system = examined.target_system
    if system is None and findings.vehicle and any(x.code == "several_vehicles" for x in findings.limits):
        system = findings.vehicle.system
    return "" if system is None else f" --target-system {system}"
