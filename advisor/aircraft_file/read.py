"""Reader of the aircraft file: YAML to :class:`advisor.aircraft.aircraft.Aircraft`, with every mistake
listed at once."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from difflib import get_close_matches
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from advisor.aircraft.aircraft import Aircraft, Elevator, Markers, Pairs, SideControl, TableColumns
from advisor.aircraft.key import keys_of, sections_of
from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS, FmuVariables
from advisor.aircraft_file.estimation import effects_schema, mistakes_in, mistakes_in_estimation
from advisor.process.settings_file import settings_of, strict
from advisor.process.yaml_file import read_yaml
from advisor.words.problems import printable


def load_aircraft(path: Path | None) -> Aircraft:
    """Read an aircraft file. Without a path, return the defaults.

    Raises
    ------
    ConfigurationError
        The file cannot be read, is not plain YAML, or contains unknown keys or unusable values.
    """
    if path is None:
        return Aircraft()
    content = read_yaml(path, _EXAMPLE)
    return parse_aircraft({} if content is None else content, str(path), _EXAMPLE)


def parse_aircraft(content: Any, origin: str = "aircraft file", mend: str = "") -> Aircraft:
    """Turn the parsed YAML into an aircraft.

    Parameters
    ----------
    origin
        Name of the file or other source of the content, for the sentence about mistakes.

    Raises
    ------
    ConfigurationError
        Lists every mistake with its path, e.g. ``elevator.calibration[1]``.
    """
    aircraft = settings_of(content, _kind(), origin, mend, _beyond_types, _meant)
    return replace(aircraft, name=printable(aircraft.name))


def aircraft_schema() -> dict[str, Any]:
    """Return the JSON schema of the aircraft file, with meaning and cost of each key, for an editor."""
    schema = TypeAdapter(_kind()).json_schema()
    schema["properties"]["effects"] |= effects_schema()
    return schema


def _kind() -> type[Aircraft]:
    # The core's dataclasses stay free of pydantic. The rule that unknown keys are refused is attached here.
    for part in _PARTS:
        strict(part)
    return Aircraft


def _meant(path: str) -> str:
    """Return a question that names the known key resembling an unknown key; empty without a similar key."""
    section, _, key = path.rpartition(".")
    by_path = {re.sub(r"\[\]", "", at): kind for at, kind in sections_of(Aircraft)}
    here = by_path.get(re.sub(r"\[\d+\]", "", section))
    mine = [field.name for field in fields(here)] if here is not None else []
    elsewhere = {
        field.name: f"{at}.{field.name}" if at else field.name
        for at, kind in reversed(by_path.items())
        for field in fields(kind)
    }
    begun = [name for name in mine if name.startswith(f"{key}_")]
    near = [*begun, *get_close_matches(key, mine, 1)]
    far = get_close_matches(key, [name for name in elsewhere if name != key], 1)
    meant = near[0] if near else elsewhere[key] if key in elsewhere else elsewhere[far[0]] if far else ""
    return f" (did you mean {meant}?)" if meant else ""


_PARTS = tuple(dict.fromkeys(kind for _, kind in sections_of(Aircraft)))[::-1]
"""The sections of the file, innermost first."""
_EXAMPLE = "To see every key with its meaning, type: advisor aircraft new --blank -o example.yaml."
"""Sentence on the next step after a file was refused."""
_MOST_POINTS = 500
"""Largest number of points of a calibration: one for every second microsecond of a servo's travel."""
_LONGEST_WINDOW = 50
"""Largest window of the paper's stop rule, Eq. (12), in manoeuvres. No flight has as many manoeuvres."""
_OUTPUTS = 32
"""Number of servo outputs in SERVO_OUTPUT_RAW and ACTUATOR_OUTPUT_STATUS."""
_LONGEST_STEP_S = 0.1
"""Longest communication step of an FMU, s. A short period of one second still has ten such steps."""


def _beyond_types(aircraft: Aircraft) -> Iterator[str]:
    """Yield mistakes that the types of the keys do not exclude, as ``path: description``."""
    yield from _elevator_mistakes(aircraft.elevator)
    for name in ("aileron", "rudder"):
        yield from _side_control_mistakes(name, getattr(aircraft, name))
    yield from _source_mistakes("alpha.source", aircraft.alpha.source, ("auto", "aoa_ssa", "derived", "none"))
    yield from _source_mistakes("beta.source", aircraft.beta.source, ("auto", "aoa_ssa", "none"))
    yield from _out_of_bounds(aircraft)
    for name in aircraft.model:
        if name not in (*PARAMETERS, *SIDE_PARAMETERS):
            yield f"model.{name}: unknown key, the parameters are {' '.join((*PARAMETERS, *SIDE_PARAMETERS))}"
    yield from mistakes_in(aircraft.effects)
    plan = aircraft.campaign
    if not 2 <= plan.window <= _LONGEST_WINDOW:
        yield (
            "campaign.window: must be at least 2, because a scatter needs two values, and at most "
            f"{_LONGEST_WINDOW}, is {plan.window}"
        )
    for i, name in enumerate(plan.parameters):
        if name not in PARAMETERS:
            yield f"campaign.parameters[{i}]: {name!r} is none of {' '.join(PARAMETERS)}"
    for name, value in plan.tolerance.items():
        if name not in PARAMETERS:
            yield f"campaign.tolerance.{name}: unknown key, the parameters are {' '.join(PARAMETERS)}"
        elif value <= 0.0:
            yield f"campaign.tolerance.{name}: must be above 0, is {value}"
    yield from mistakes_in_estimation(aircraft.estimation)
    yield from _mistakes_in_markers(aircraft.markers)
    if aircraft.fmu is not None:
        yield from _mistakes_in_fmu(aircraft.fmu)
    if aircraft.columns is not None:
        yield from _mistakes_in_scale("columns.scale", aircraft.columns.scale, _COLUMNS)


def _out_of_bounds(aircraft: Aircraft) -> Iterator[str]:
    """Yield the values outside the bounds of their keys."""
    for key in keys_of(Aircraft):
        value: Any = aircraft
        for name in key.path.split("."):
            value = getattr(value, name, None)
        if mistake := key.mistake(value):
            yield f"{key.path}: {mistake}"


def _source_mistakes(path: str, source: str, sources: Sequence[str]) -> Iterator[str]:
    named = source.startswith("named_value:") and 1 <= len(source.split(":", 1)[1]) <= 10
    if source not in sources and not named:
        yield f"{path}: {source!r} is none of {', '.join(sources)}, named_value:NAME"


def _elevator_mistakes(elevator: Elevator) -> Iterator[str]:
    if isinstance(elevator.output, int) and not 1 <= elevator.output <= _OUTPUTS:
        yield f"elevator.output: {elevator.output} is not a servo output 1..{_OUTPUTS} (or auto)"
    if elevator.calibration is not None:
        yield from _calibration_mistakes("elevator.calibration", elevator.calibration)
    if elevator.outputs and (elevator.output != "auto" or elevator.calibration is not None):
        yield (
            "elevator.outputs: replaces elevator.output and elevator.calibration; remove these, or the list"
        )
    if len(elevator.outputs) > _OUTPUTS:
        yield f"elevator.outputs: lists {len(elevator.outputs)} outputs; there are {_OUTPUTS}"
        return
    for i, output in enumerate(elevator.outputs):
        path = f"elevator.outputs[{i}]"
        if not 1 <= output.output <= _OUTPUTS:
            yield f"{path}.output: {output.output} is not a servo output 1..{_OUTPUTS}"
        if output.output in [other.output for other in elevator.outputs[:i]]:
            yield f"{path}.output: {output.output} is listed twice"
        if output.weight <= 0.0:
            yield f"{path}.weight: must be above 0, is {output.weight}"
        if output.calibration is not None:
            yield from _calibration_mistakes(f"{path}.calibration", output.calibration)
        elif elevator.is_calibrated:
            yield f"{path}.calibration: give one for every output, or for none"


def _side_control_mistakes(name: str, control: SideControl) -> Iterator[str]:
    if isinstance(control.output, int) and not 1 <= control.output <= _OUTPUTS:
        yield f"{name}.output: {control.output} is not a servo output 1..{_OUTPUTS} (or auto)"
    if control.calibration is not None:
        yield from _calibration_mistakes(f"{name}.calibration", control.calibration)


def _calibration_mistakes(path: str, points: Pairs) -> Iterator[str]:
    if len(points) > _MOST_POINTS:
        yield f"{path}: has {len(points)} points; give at most {_MOST_POINTS}"
        return
    if len(points) < 2:
        yield f"{path}: needs at least two points [PWM us, deflection deg]"
    for i, (below, above) in enumerate(pairwise(points), start=1):
        if above[0] <= below[0]:
            yield f"{path}[{i}]: PWM must rise from point to point"
    rises = {(b[1] > a[1]) - (b[1] < a[1]) for a, b in pairwise(points)}
    if len(rises) > 1 or rises == {0}:
        yield f"{path}: deflection must rise all the way or fall all the way"


def _mistakes_in_markers(markers: Markers) -> Iterator[str]:
    if markers.rc is not None and not 1 <= markers.rc <= 18:
        yield f"markers.rc: {markers.rc} is not a channel 1..18 of RC_CHANNELS"
    if markers.text is not None:
        begins, ends = markers.text
        if not begins.strip() or not ends.strip() or begins == ends:
            yield "markers.text: needs two different texts, [begins, ends]"


_FMU_VARIABLES = tuple(
    field.name for field in fields(FmuVariables) if field.name not in ("units", "scale", "step_s", "trim")
)


_COLUMNS = tuple(field.name for field in fields(TableColumns) if field.name not in ("units", "scale"))


def _mistakes_in_scale(path: str, scale: Mapping[str, float], names: Sequence[str]) -> Iterator[str]:
    for name, factor in scale.items():
        if name not in names:
            yield f"{path}.{name}: unknown key, the variables are {' '.join(names)}"
        elif factor == 0.0:
            yield f"{path}.{name}: must not be 0"


def _mistakes_in_fmu(fmu: FmuVariables) -> Iterator[str]:
    yield from _mistakes_in_scale("fmu.scale", fmu.scale, _FMU_VARIABLES)
    if fmu.step_s is not None and not 0.0 < fmu.step_s <= _LONGEST_STEP_S:
        yield f"fmu.step_s: {fmu.step_s} s is outside 0..{_LONGEST_STEP_S}"
    if (fmu.force_increment is None) != (fmu.moment_increment is None):
        yield "fmu.force_increment: needs fmu.moment_increment as well; give both, or none"
    if fmu.trim.theta is not None and fmu.trim.alpha is None:
        yield "fmu.trim.theta: needs fmu.trim.alpha"
