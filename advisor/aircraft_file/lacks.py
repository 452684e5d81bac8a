"""Keys that are missing in an aircraft file, and the cost of each missing key."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from operator import attrgetter

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.key import keys_of
from advisor.aircraft_file.log_facts import LogFacts
from advisor.flight.elevator.axes.side_controls import SIDES
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.vehicle.surfaces import Surface

KEYS = tuple(key for key in keys_of(Aircraft) if key.example)
"""Keys that a new aircraft file contains."""


BEYOND_US = 20.0
"""Largest excess of pulses over a calibration without a warning, us. The trims of servo and transmitter
differ by about this much.
"""


@dataclass(frozen=True, slots=True)
class Lack:
    """One key of an aircraft file that is missing, or that contradicts the log."""

    key: str
    """Path of the key in the aircraft file."""
    cost: str
    """Sentence on the cost of the missing key."""
    mend: str
    """Clause on the remedy in the aircraft file."""
    wrong: bool = False
    """Whether the key exists and contradicts the log."""


def lacks_of(aircraft: Aircraft, facts: LogFacts | None = None) -> tuple[Lack, ...]:
    """Return the keys that contradict the log, then the missing keys in the order of the file.

    Parameters
    ----------
    facts
        Facts of a log of this aircraft. None: the file is checked without a log.
    """
    lacks = [
        Lack(key.path, key.cost, key.mend)
        for key in KEYS
        if key.cost and _counts(key.path, aircraft, facts) and not _given(key.path, aircraft)
    ]
    return (*(_contradictions(aircraft, facts) if facts else ()), *lacks)


def _given(path: str, aircraft: Aircraft) -> bool:
    """Return whether the aircraft file has the key, or another key that replaces it."""
    match path:
        case "elevator.output":
            return aircraft.elevator.output != "auto" or bool(aircraft.elevator.outputs)
        case "aileron.output":
            return aircraft.aileron.output != "auto"
        case "rudder.output":
            return aircraft.rudder.output != "auto"
        case "elevator.calibration":
            return aircraft.elevator.is_calibrated
        case "model":
            return bool(aircraft.model) or aircraft.simulator is not None
    return attrgetter(path)(aircraft) is not None


def _counts(path: str, aircraft: Aircraft, facts: LogFacts | None) -> bool:
    """Return whether a missing key costs anything on this aircraft."""
    section, _, _ = path.partition(".")
    if section in SIDES and facts is not None and facts.wiring.roles and section not in facts.sides:
        # An aircraft whose parameters name other surfaces may have no rudder.
        return False
    match path:
        case "elevator.output":
            return facts is None or not isinstance(facts.elevator, Surface)
        case "aileron.output" | "rudder.output":
            return facts is None or section not in facts.sides
        case "airspeed_m_s":
            return facts is not None and facts.airspeed_m_s is None
        case "alpha.vane_arm_m":
            stated = aircraft.alpha.source.startswith("named_value:")
            return stated or (facts is not None and facts.alpha_provenance == "vane")
    return True


def _contradictions(aircraft: Aircraft, facts: LogFacts) -> Iterator[Lack]:
    if not isinstance(facts.elevator, Surface):
        yield Lack("elevator.output", facts.elevator.text, facts.elevator.fix.rstrip("."), wrong=True)
    yield from _beyond_calibration(aircraft, facts)
    wanted = aircraft.alpha.source
    if wanted not in ("auto", "none") and facts.alpha_source is None:
        yield Lack(
            "alpha.source",
            f"The log has no angle of attack by {wanted}.",
            "record the source that alpha.source names, or write alpha.source: auto",
            wrong=True,
        )
    reference = aircraft.reference_airspeed_m_s
    if reference is not None and facts.airspeed_m_s is not None:
        low, _, high = facts.airspeed_m_s
        if not low <= reference <= high:
            yield Lack(
                "reference_airspeed_m_s",
                f"The derivatives are carried over to {reference:g} m/s; the log was flown at "
                f"{low:.1f} to {high:.1f} m/s.",
                "write an air speed within the range that was flown",
                wrong=True,
            )


def _beyond_calibration(aircraft: Aircraft, facts: LogFacts) -> Iterator[Lack]:
    """Yield the outputs whose pulses exceed their calibration, beyond which the deflection is constant."""
    calibrations = {output.output: output.calibration for output in aircraft.elevator.outputs}
    if aircraft.elevator.calibration and len(facts.outputs) == 1:
        calibrations = {facts.outputs[0]: aircraft.elevator.calibration}
    for output, pairs in calibrations.items():
        if pairs is None or output not in facts.pulses_us:
            continue
        low, high = facts.pulses_us[output]
        first, last = min(pwm for pwm, _ in pairs), max(pwm for pwm, _ in pairs)
        if low < first - BEYOND_US or high > last + BEYOND_US:
            yield Lack(
                "elevator.calibration",
                f"Output {output} moves from {low:.0f} to {high:.0f} us in the log, the calibration ends at "
                f"{first:.0f} and {last:.0f} us: outside, the deflection is constant.",
                "measure the deflection at the pulses that were flown",
                wrong=True,
            )


_OF_QUANTITY: Mapping[str, str] = {"sign": "calibration", "scale": "calibration", "unit": "source"}
"""Key of the aircraft file that states a property of an instrument, by the property's name."""


def contradicted(findings: Iterable[InstrumentFinding]) -> list[Lack]:
    """Return the keys that the motion of a log contradicts, with the sentences of the analysis."""
    return [
        Lack(
            f"{finding.channel}.{_OF_QUANTITY.get(finding.quantity, finding.quantity)}",
            f"{finding.sentence}.",
            finding.fix or "see the sentence above",
            wrong=True,
        )
        for finding in findings
        if finding.contradicts
    ]


def known_keys(aircraft: Aircraft) -> list[str]:
    """Return the paths of the keys that a file has, among all keys whose absence has a cost."""
    return [key.path for key in KEYS if key.cost and _given(key.path, aircraft)]
