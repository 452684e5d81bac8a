"""``advisor gap`` outside the core: logs in, improved simulator out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from advisor.aircraft import Aircraft
from advisor.flight.events import ManeuverFlown
from advisor.flight.maneuver import Maneuver
from advisor.flight.stream import FlightStream
from advisor.gap.candidates.known import together
from advisor.gap.diagnose import diagnose
from advisor.gap.result import Diagnosis
from advisor.mavlink.logs import open_log
from advisor.problems import UnusableInputError


def maneuvers_of(
    logs: Sequence[Path], aircraft: Aircraft, target_system: int | None = None
) -> list[Maneuver]:
    """Every manoeuvre of all logs once, numbered through.

    Raises
    ------
    UnusableInputError
        A log cannot be read or cannot serve.
    """
    return _each_once(_recorded(logs, aircraft, target_system))


def _recorded(logs: Sequence[Path], aircraft: Aircraft, target_system: int | None) -> list[Maneuver]:
    """What the logs hold, log by log."""
    found: list[Maneuver] = []
    for log in logs:
        stream = FlightStream(aircraft, target_system)
        events = [event for columns in open_log(log) for event in stream.feed(columns)]
        events += stream.finish()
        for problem in stream.problems():
            raise UnusableInputError(problem.code, f"{log.name}: {problem.text}", problem.fix)
        found += [e.maneuver for e in events if isinstance(e, ManeuverFlown)]
    return found


def _each_once(recorded: Sequence[Maneuver]) -> list[Maneuver]:
    """Without what comes again, as from a copy of a log: it would confirm itself."""
    found: list[Maneuver] = []
    for maneuver in recorded:
        if not any(_is_the_same(maneuver, other) for other in found):
            found.append(replace(maneuver, number=len(found) + 1))
    return found


def _is_the_same(a: Maneuver, b: Maneuver) -> bool:
    """Whether two records are of one manoeuvre: every channel at the same stamps, to the last digit."""
    return a.channels.keys() == b.channels.keys() and all(
        np.array_equal(channel.t, b.channels[name].t) and np.array_equal(channel.y, b.channels[name].y)
        for name, channel in a.channels.items()
    )


def diagnose_logs(
    logs: Sequence[Path],
    aircraft: Aircraft,
    holdout: int | None = None,
    target_system: int | None = None,
    progress: Callable[[str, float], None] = lambda *_: None,
) -> Diagnosis:
    """Read logs and diagnose their gap."""
    progress("reading", 0.0)
    recorded = _recorded(logs, aircraft, target_system)
    maneuvers = _each_once(recorded)
    found = diagnose(maneuvers, aircraft, holdout, progress)
    again = len(recorded) - len(maneuvers)
    if not again:
        return found
    note = (
        f"{again} of {len(recorded)} manoeuvres came twice, as from the same log or a copy: they count once."
    )
    return replace(found, notes=(note, *found.notes))


def improved_file(diagnosis: Diagnosis, aircraft: Aircraft) -> Mapping[str, Any]:
    """The aircraft file with the fitted model and the effects found in it."""
    content: dict[str, Any] = {"name": f"{aircraft.name}, improved"}
    kept = replace(aircraft, name=Aircraft().name, model={}, effects={})
    content.update(_beyond(asdict(kept), asdict(Aircraft())))
    if diagnosis.reference_airspeed_m_s is not None:
        content["reference_airspeed_m_s"] = round(diagnosis.reference_airspeed_m_s, 4)
    content["model"] = {name: _digits(v.value) for name, v in diagnosis.model.items()}
    content["effects"] = {
        effect: {name: _digits(value) for name, value in values.items()}
        for effect, values in together(aircraft.effects, diagnosis.effects).items()
    }
    return content


def _beyond(content: Mapping[str, Any], usual: Mapping[str, Any]) -> dict[str, Any]:
    """What a file must say because it is not what is taken without it, section by section."""
    found = {}
    for key, value in content.items():
        if isinstance(value, Mapping) and (inside := _beyond(value, usual.get(key, {}))):
            found[key] = inside
        elif not isinstance(value, Mapping) and value != usual.get(key):
            found[key] = value
    return found


def write_improved(diagnosis: Diagnosis, aircraft: Aircraft, path: Path) -> Path:
    """Write the improved simulator as a file that ``advisor`` and ``python -m sim`` load."""
    text = yaml.safe_dump(_plain(improved_file(diagnosis, aircraft)), sort_keys=False, allow_unicode=True)
    head = "# Written by `advisor gap`: the simulator with what the flight showed.\n"
    path.write_text(head + text, encoding="utf-8")
    return path


def improved_name(diagnosis: Diagnosis, aircraft_file: Path | None) -> str:
    """``<aircraft>-with-<effect>.yaml``."""
    stem = aircraft_file.stem if aircraft_file is not None else "aircraft"
    first = next(iter(diagnosis.effects), "fitted-model")
    return f"{stem}-with-{first.replace('_', '-')}.yaml"


def _digits(x: float) -> float:
    return float(f"{x:.6g}")


def _plain(value: Any) -> Any:
    """Tuples as lists, so that the file reads as people write it."""
    if isinstance(value, Mapping):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value
