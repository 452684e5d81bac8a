"""A new aircraft file from one log, and its text."""

from dataclasses import dataclass, field
from math import isfinite
from statistics import median
from textwrap import wrap
from typing import Any

import yaml

from advisor.aircraft.key import Key
from advisor.aircraft_file.log_facts import KEYS, LogFacts
from advisor.flight.elevator.elevator_guess import Guess
from advisor.flight.elevator.elevator_outputs import SIDES
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA
from advisor.flight.signals.track import standard_density
from advisor.flight.vehicle.surfaces import Scale, Surface, joined_numbers
from advisor.words.problems import Problem

_WIDTH = 100
"""Width of a comment line, in characters."""


@dataclass(slots=True)
class Draft:
    """Content of an aircraft file before it is written."""

    head: list[str] = field(default_factory=list)
    """Sentences at the beginning of the file."""
    values: dict[str, Any] = field(default_factory=dict)
    """Value of each key, by the key's path."""
    comments: dict[str, str] = field(default_factory=dict)
    """Source of each key's value, or the known facts instead of a value, by the key's path."""
    examples: dict[str, str] = field(default_factory=dict)
    """Example of a value in the comment of each key without a value, by the key's path."""
    needless: set[str] = field(default_factory=set)
    """Paths of keys that this aircraft does not need."""
    unsure: list[str] = field(default_factory=list)
    """Sentences on points that the user must check."""


def aircraft_text(draft: Draft) -> str:
    """Return the text of an aircraft file from its draft.

    Returns
    -------
    YAML that ``advisor.aircraft_file.read.parse_aircraft`` reads. A key without a value is a comment.
    """
    lines = [line for sentence in draft.head for line in _commented(sentence)]
    section = ""
    for key in KEYS:
        if key.path in draft.needless:
            continue
        within = key.path.rpartition(".")[0]
        if within != section:
            section = within
            # An empty section counts as left for later.
            lines += ["", f"{section}:"] if section else [""]
        lines += _entry(key, "  " if section else "", draft)
    return "\n".join(lines) + "\n"


def _entry(key: Key, indent: str, draft: Draft) -> list[str]:
    said, meaning = draft.comments.get(key.path, ""), key.meaning.replace("``", "")
    if key.path in draft.values:
        about, line = said or meaning.rstrip("."), f"{indent}{key.name}: {_inline(draft.values[key.path])}"
        beside = f"{line}  # {about}"
        return [beside] if len(beside) <= _WIDTH else [*_commented(about, indent), line]
    cost = f"Without it: {key.cost[0].lower()}{key.cost[1:]}" if key.cost else ""
    notes = [meaning, cost, said]
    lines = [line for note in notes if note for line in _commented(note, indent)]
    return [*lines, f"{indent}# {key.name}: {draft.examples.get(key.path, key.example)}"]


def _commented(sentence: str, indent: str = "") -> list[str]:
    return [f"{indent}# {line}" for line in wrap(sentence, _WIDTH - len(indent))]


def _inline(value: Any) -> str:
    """Return a value as one line of YAML."""
    text: str = yaml.safe_dump(
        value, default_flow_style=True, allow_unicode=True, width=10_000, sort_keys=False
    )
    return text.removesuffix("\n").removesuffix("...").strip()


_FULL_STROKE_DEG = 25.0
"""Deflection that is assumed at a servo's end point without a measurement, deg."""


def proposed(facts: LogFacts, log: str) -> Draft:
    """Return a draft of an aircraft file with the facts of a log."""
    draft = Draft(head=_head(facts, log))
    _elevator(facts, draft)
    if facts.sides_unknown is not None and len(facts.side_guesses) < len(SIDES) - len(facts.sides):
        draft.unsure.append(str(facts.sides_unknown))
    for name, guess in facts.side_guesses.items():
        _guessed(name, guess, facts, draft)
    for name, surface in facts.sides.items():
        _control(name, surface, facts, draft)
    _alpha(facts, draft)
    _airspeed(facts, log, draft)
    return draft


def _head(facts: LogFacts, log: str) -> list[str]:
    vehicle = facts.vehicle
    firmware = f" {vehicle.firmware}" if vehicle.firmware else ""
    flown = len(facts.maneuvers_m_s)
    lines = [
        f"Aircraft file of the inflight advisor, made from {log}: {vehicle.autopilot}{firmware}, "
        f"{facts.frame}, system {vehicle.system}, {flown or 'no'} manoeuvre{'' if flown == 1 else 's'}."
    ]
    if facts.pressure_pa is not None:
        lines.append(
            f"Static pressure {0.01 * facts.pressure_pa:.0f} hPa: a density of "
            f"{standard_density(facts.pressure_pa):.3f} kg/m³ in the standard atmosphere. "
            "The log's pressure is used; the file needs none."
        )
    lines.append("Remove the # in front of a key once you know the value; every key may be left out.")
    return lines


def _elevator(facts: LogFacts, draft: Draft) -> None:
    if isinstance(facts.elevator, Problem):
        _unknown_elevator(facts, facts.elevator, draft)
        return
    surface = facts.elevator
    if len(surface.parts) > 1:
        _found_by_function("elevator", surface, facts, draft)
        limits = " ".join(_limits(facts, n) for n in surface.outputs)
        listed = ", ".join(f"{{output: {n}, calibration: [[PWM, deg], ...]}}" for n in surface.outputs)
        draft.comments["elevator.calibration"] = (
            f"{limits} After measuring, replace output by a calibration for each output: outputs: [{listed}]."
        )
        return
    output = surface.outputs[0]
    draft.values["elevator.output"] = output
    why = facts.wiring.assumed or f"by {facts.wiring.words.elevator} in the log"
    draft.comments["elevator.output"] = why.rstrip(".")
    _calibration(facts, output, draft)


def _control(name: str, surface: Surface, facts: LogFacts, draft: Draft) -> None:
    """Write the outputs of the aileron or the rudder into the draft."""
    if len(surface.parts) > 1:
        _found_by_function(name, surface, facts, draft)
        return
    draft.values[f"{name}.output"] = surface.outputs[0]
    draft.comments[f"{name}.output"] = f"by {facts.wiring.words.function} in the log"
    _calibration(facts, surface.outputs[0], draft, name)


def _found_by_function(name: str, surface: Surface, facts: LogFacts, draft: Draft) -> None:
    several = joined_numbers(surface.outputs)
    draft.values[f"{name}.output"] = "auto"
    draft.comments[f"{name}.output"] = f"finds outputs {several} by {facts.wiring.words.function}"


def _unknown_elevator(facts: LogFacts, problem: Problem, draft: Draft) -> None:
    if facts.guess is None:
        draft.comments["elevator.output"] = f"{problem.text} Usual: {facts.wiring.words.usual}."
        draft.unsure.append(f"The elevator is unknown: {problem.text} Write elevator.output by hand.")
        return
    _guessed("elevator", facts.guess, facts, draft)


def _guessed(name: str, guess: Guess, facts: LogFacts, draft: Draft) -> None:
    draft.values[f"{name}.output"] = guess.output
    draft.comments[f"{name}.output"] = f"GUESS, check: {guess}"
    _calibration(facts, guess.output, draft, name)
    draft.unsure.append(f"Check {name}.output: {guess}.")


def _calibration(facts: LogFacts, output: int, draft: Draft, name: str = "elevator") -> None:
    """Write the limits of one output into the draft, instead of the usual example."""
    draft.comments[f"{name}.calibration"] = _limits(facts, output)
    scale = facts.stated_scale(output)
    if scale is not None:
        draft.examples[f"{name}.calibration"] = _as_calibration(scale)


def _limits(facts: LogFacts, output: int) -> str:
    """Return the travel of a servo output in the log, in one sentence or two."""
    scale = facts.stated_scale(output)
    said = []
    if scale is not None:
        said.append(
            f"Output {output} by {facts.wiring.words.limits}: {scale.low_us:g}/{scale.trim_us:g}/"
            f"{scale.high_us:g} us{', reversed' if scale.reversed else ''}."
        )
    if output in facts.pulses_us:
        low, high = facts.pulses_us[output]
        said.append(f"The output's pulses in this log reach from {low:.0f} to {high:.0f} us.")
    return " ".join(said)


def _as_calibration(scale: Scale) -> str:
    down = _FULL_STROKE_DEG if scale.reversed else -_FULL_STROKE_DEG
    points = ((scale.low_us, -down), (scale.trim_us, 0.0), (scale.high_us, down))
    return "[" + ", ".join(f"[{pwm:g}, {deg:.1f}]" for pwm, deg in points) + "]"


def _alpha(facts: LogFacts, draft: Draft) -> None:
    if facts.alpha_source is None:
        draft.comments["alpha.source"] = "This log has no angle of attack: estimates use pitch rate and a_z."
        return
    draft.values["alpha.source"] = "auto"
    draft.comments["alpha.source"] = f"the log has {facts.alpha_source}, {_kind(facts)}"
    if facts.alpha_source == DERIVED_ALPHA:
        draft.needless.add("alpha.vane_arm_m")


def _kind(facts: LogFacts) -> str:
    """Return a clause on the source of the angle of attack."""
    if facts.alpha_source == DERIVED_ALPHA:
        return "derived from attitude, climb rate and air speed, without a vane"
    return {
        "vane": "a vane",
        "derived": "the autopilot's own estimate, unless a vane feeds it",
        "simulated": "of a simulator",
    }.get(facts.alpha_provenance, "which may be a vane or an estimate")


def _airspeed(facts: LogFacts, log: str, draft: Draft) -> None:
    if facts.airspeed_m_s is None:
        draft.unsure.append(f"{log} has no air speed: write airspeed_m_s, the speed that was flown.")
        return
    low, middle, high = facts.airspeed_m_s
    draft.needless.add("airspeed_m_s")
    speeds = [speed for speed in facts.maneuvers_m_s if isfinite(speed)]
    draft.values["reference_airspeed_m_s"] = round(median(speeds) if speeds else middle, 1)
    draft.comments["reference_airspeed_m_s"] = (
        f"derivatives are given at this speed, the median of {'the manoeuvres' if speeds else 'the flight'}; "
        f"flown: {low:.1f} to {high:.1f} m/s"
    )
