"""Comparison of expectations with a flight. Each outcome holds the expectation, the flight's result, and
whether the expectation holds; JSON and JUnit XML state the outcomes.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SPEED_EXPONENTS
from advisor.expectations.flown import Flown, Measured
from advisor.expectations.read import MODES, Expectations, Near, mode_of
from advisor.words.axes import AxisName
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem
from advisor.words.quantities import NORMAL_95, PARAMETERS, SIDE_PARAMETERS, decimals_for, signed, with_half

UNITS = {**{name: quantity.unit for name, quantity in {**PARAMETERS, **SIDE_PARAMETERS}.items()}, **MODES}
UNITS |= {"Z_0": "rad/s", "M_0": "rad/s²"}
"""SI unit of each derivative and mode, by its key in the file."""
_ORIGINS = {"number": "", "model": " (model)", "log": " (log)"}


@dataclass(frozen=True, slots=True)
class Outcome:
    """One expectation, and the result of a flight for it."""

    name: str
    """Path of the expectation in its file: ``derivatives.M_alpha``."""
    asked: str
    """Expectation in words, with its limit."""
    found: str
    """Result of the flight in words; without a result, the reason."""
    holds: bool


def check(
    expected: Expectations, flown: Flown, aircraft: Aircraft, other: Flown | None = None
) -> list[Outcome]:
    """Return the outcome of every expectation, in the order of the file's sections.

    Parameters
    ----------
    aircraft
        Aircraft whose model states the values of ``of: model``.
    other
        Results of the log that states the values of ``of: log``; None without such a log.
    """
    return [
        *_counts(expected, flown),
        *_numbers("derivatives", expected, flown, aircraft, other),
        *_numbers("modes", expected, flown, aircraft, other),
        *_levels(expected, flown),
        *_gaps(expected, flown),
        *_pauses(expected, flown),
        *_alarms(expected, flown),
    ]


def _counts(expected: Expectations, flown: Flown) -> Iterator[Outcome]:
    for axis, least in expected.accepted.items():
        count = flown.accepted.get(axis, 0)
        yield Outcome(f"accepted.{axis}", f"at least {least}", str(count), count >= least)
    for axis, latest in expected.complete.items():
        test = flown.tests.get(axis)
        at = test.stopped_at if test is not None and test.decision == "stop" else None
        shown = "not complete" if at is None else f"manoeuvre {at}"
        yield Outcome(f"complete.{axis}", f"by manoeuvre {latest}", shown, at is not None and at <= latest)


def _numbers(
    section: str, expected: Expectations, flown: Flown, aircraft: Aircraft, other: Flown | None
) -> Iterator[Outcome]:
    nears, shown = getattr(expected, section), getattr(flown, section)
    for name, near in nears.items():
        measured = shown.get(name, Measured(reason="roll and yaw were not flown"))
        against = _expected_value(section, name, near, flown, aircraft, other)
        yield _near(f"{section}.{name}", near, against, measured, UNITS[name].removesuffix("1"))


def _expected_value(
    section: str, name: str, near: Near, flown: Flown, aircraft: Aircraft, other: Flown | None
) -> Measured:
    if near.origin == "log":
        assert other is not None
        shown: Mapping[str, Measured] = getattr(other, section)
        measured = shown.get(name, Measured(reason="roll and yaw were not flown"))
        if section == "modes":
            return measured
        return replace(measured, value=measured.value * _faster(name, flown, other.airspeeds_m_s))
    value = near.value
    if near.origin == "model":
        model = _model_as_flown(aircraft, flown)
        value = mode_of(model, name, flown.trim) if section == "modes" else model[name]
        if value is None:
            return Measured(reason="the file's model does not have this mode")
    return Measured() if value is None else Measured(value)


def _model_as_flown(aircraft: Aircraft, flown: Flown) -> dict[str, float]:
    """Return the aircraft file's model at the air speed of the flight. Without a ``reference_airspeed_m_s``
    the model is returned as stated."""
    read = aircraft.reference_airspeed_m_s
    stated = {} if read is None else dict.fromkeys(flown.airspeeds_m_s, read * flown.true_over_read)
    return {name: value * _faster(name, flown, stated) for name, value in aircraft.model.items()}


def _faster(name: str, flown: Flown, stated_m_s: Mapping[AxisName, float]) -> float:
    """Return the factor on a derivative from a stated true air speed to that of the flight; 1 if either
    is unknown."""
    axis: AxisName = "pitch" if name in PARAMETERS else "lateral"
    speeds = flown.airspeeds_m_s
    if axis not in stated_m_s or axis not in speeds:
        return 1.0
    return float((speeds[axis] / stated_m_s[axis]) ** SPEED_EXPONENTS[name])


def _near(path: str, near: Near, against: Measured, measured: Measured, unit: str) -> Outcome:
    """Return whether a measured number lies within its tolerance, and is known well enough."""
    asked, holds = [], not measured.reason and not against.reason
    half = NORMAL_95 * measured.std
    allowed = near.tolerance(against.value)
    if against.reason:
        asked.append(f"that of the {near.origin}: {against.reason}")
    elif allowed is not None:
        decimals = decimals_for(allowed)
        limit, value = signed(allowed, decimals), signed(against.value, decimals)
        asked.append(f"within {limit} of {value}{_ORIGINS[near.origin]}")
        holds = holds and abs(measured.value - against.value) <= allowed
    if near.known_to is not None:
        asked.append(f"known to ± {near.known_to:g}")
        holds = holds and half <= near.known_to
    shown = with_half(measured.value, half) if isfinite(half) else signed(measured.value, 3)
    return Outcome(path, ", ".join(asked), measured.reason or f"{shown} {unit}".rstrip(), holds)


def _levels(expected: Expectations, flown: Flown) -> Iterator[Outcome]:
    for axis, worst in expected.levels.items():
        levels = {level.category: level for level in flown.levels.get(axis, ())}
        for category, allowed in worst.items():
            level = levels.get(category)
            asked = "Level 1" if allowed == 1 else f"Level {allowed} or better"
            shown = "none: the flight does not show the modes" if level is None else level.sentence
            shown = shown.removeprefix(f"Category {category}: ")
            holds = level is not None and level.level <= allowed
            yield Outcome(f"levels.{axis}.{category}", asked, shown, holds)


def _gaps(expected: Expectations, flown: Flown) -> Iterator[Outcome]:
    for axis, largest in expected.gap.items():
        gap = flown.gap.get(axis, Measured(reason="not diagnosed"))
        shown = gap.reason or f"{gap.value:.3g}"
        yield Outcome(f"gap.{axis}", f"at most {largest:g}", shown, gap.value <= largest)


def _pauses(expected: Expectations, flown: Flown) -> Iterator[Outcome]:
    for channel, longest in expected.longest_pause_s.items():
        pause = flown.pauses_s.get(channel)
        shown = "not in this log" if pause is None else f"{pause:.3g} s"
        holds = pause is not None and pause <= longest
        yield Outcome(f"longest_pause_s.{channel}", f"at most {longest:g} s", shown, holds)


def _alarms(expected: Expectations, flown: Flown) -> Iterator[Outcome]:
    if expected.alarms is not None:
        count, most = len(flown.alarms), expected.alarms
        shown = "none" if not count else f"{count}: {'; '.join(flown.alarms)}"
        yield Outcome("alarms", f"at most {most}" if most else "none", shown, count <= most)


SCHEMA = "advisor.expect/1"


def expect_document(
    log: str, file: str, outcomes: Sequence[Outcome], problems: Sequence[Problem] = ()
) -> dict[str, Any]:
    """Return the document of ``advisor expect --json``; an unusable log has problems and no outcomes."""
    return {
        "schema": SCHEMA,
        "usable": not problems,
        "problems": plain(problems),
        "log": log,
        "file": file,
        "holds": None if problems else all(outcome.holds for outcome in outcomes),
        "expectations": [picked(outcome, "name asked found holds") for outcome in outcomes],
    }


def junit(log: str, file: str, outcomes: Sequence[Outcome], problems: Sequence[Problem] = ()) -> bytes:
    """Return the report as UTF-8 XML: one test case for each outcome, and one error for an unusable log.

    Parameters
    ----------
    log, file
        Names of the log and of the expectations file.
    problems
        Reasons why the log cannot be used; then there are no outcomes.
    """
    failures = sum(not outcome.holds for outcome in outcomes)
    tests = len(outcomes) + bool(problems)
    counts: dict[str, str] = {
        "tests": str(tests),
        "failures": str(failures),
        "errors": str(int(bool(problems))),
    }
    root = Element("testsuites", {"name": "advisor expect", **counts})
    suite = SubElement(root, "testsuite", {"name": log, **counts})
    for outcome in outcomes:
        case = SubElement(suite, "testcase", classname=file, name=outcome.name)
        said = f"asked: {outcome.asked}; found: {outcome.found}"
        if outcome.holds:
            SubElement(case, "system-out").text = said
        else:
            SubElement(case, "failure", message=said, type="expectation").text = said
    if problems:
        case = SubElement(suite, "testcase", classname=file, name="log")
        said = "\n".join(map(str, problems))
        SubElement(case, "error", message=said, type=problems[0].code).text = said
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'.encode()
