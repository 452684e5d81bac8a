"""The worked examples of the documentation: commands that are really run, and what they print.

Each example is a text file in ``docs/data/examples``; pages and the README show it from there.
"""

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.gap import compare_logs
from advisor.library import estimate, read
from advisor.oem.estimate import Estimate
from benchmarks.pages.figure import errors, residuals, response, stages, svg

ROOT = Path(__file__).parents[2]
LOG = ROOT / "logs" / "arduplane-calm.tlog"
AIRCRAFT = LOG.with_suffix(".yaml")
UAV = """name: uav
reference_airspeed_m_s: 22.0
reference: {mass_kg: 10.0, wing_area_m2: 0.7, chord_m: 0.28, span_m: 2.5, iyy_kg_m2: 1.1}
model: {Z_0: 0.04, Z_alpha: -4.3, Z_q: -0.03, Z_delta_e: -0.28,
        M_0: 0.0, M_alpha: -37.0, M_q: -4.8, M_delta_e: -52.0}
"""
"""An aircraft that has not flown yet."""
_SHOWN = 1
"""Index of the manoeuvre that the figures show."""
FILES: Mapping[str, str] = {"uav.yaml": UAV}
"""Aircraft files in the folder in which the examples run."""


@dataclass(frozen=True)
class Part:
    """Lines of an output that an example shows."""

    begins: str = ""
    """Start of the first line; empty: the first line of all."""
    until: str = ""
    """Start of the first line that is not shown; empty: to the end."""


@dataclass(frozen=True)
class Example:
    """A command line, and the parts of its output that pages show."""

    words: str
    """What follows ``advisor`` on the command line."""
    parts: Mapping[str, Sequence[Part]]
    """Name of the text file to the parts in it; "[...]" stands between parts."""


EXAMPLES: Sequence[Example] = (
    Example(
        "doctor logs/arduplane-default-rates.tlog", {"doctor-refuses": [Part(until="  ! AOA_SSA arrives")]}
    ),
    Example(
        "doctor logs/arduplane-calm.tlog", {"doctor": [Part()], "doctor-short": [Part(until="vehicle ")]}
    ),
    Example("aircraft new --from logs/arduplane-calm.tlog -o mine.yaml", {"aircraft-new": [Part()]}),
    Example("aircraft check mine.yaml", {"aircraft-check": [Part(until="  accelerometer.arm_m")]}),
    Example(
        "analyze logs/arduplane-calm.tlog --aircraft logs/arduplane-calm.yaml",
        {
            "analyze-maneuvers": [Part(until="arduplane-calm.tlog"), Part(" 1 ", "[1 to 7] angle of attack")],
            "analyze-estimate": [Part("Joint estimate", "note:")],
            "analyze-qualities": [Part("Flying qualities", "  static margin")],
            "analyze-rules": [Part("rule information")],
            "analyze-short": [
                Part(until="arduplane-calm.tlog:"),
                Part(" 1 ", " 3 "),
                Part("Joint estimate", "note:"),
            ],
        },
    ),
    Example(
        "gap logs/arduplane-calm.tlog --aircraft logs/arduplane-calm.yaml",
        {
            "gap": [Part(until="● in the improved")],
            "gap-next": [Part("Next:")],
        },
    ),
    Example(
        "gap logs/arduplane-calm.tlog --aircraft logs/arduplane-calm.yaml --all",
        {
            "gap-course": [Part("╭─ where in the flight", "cause ")],
            "gap-unseen": [Part("This flight could not show", "Next:")],
        },
    ),
    Example(
        "gap logs/arduplane-calm.tlog --aircraft logs/arduplane-calm.yaml --why"
        " --out arduplane-calm-with-actuator-lag.yaml",
        {"gap-why": [Part("╭─ why", "The improved simulator")]},
    ),
    Example(
        "gap logs/arduplane-calm.tlog --aircraft arduplane-calm-with-actuator-lag.yaml",
        {"gap-again": [Part(until="--all adds")]},
    ),
)
"""In the order in which they run: a later one reads what an earlier one wrote."""


def transcripts() -> Iterator[tuple[str, str]]:
    """Yield the name and the text of every example, after running its command."""
    for name, text in FILES.items():
        yield name, text
    with TemporaryDirectory() as place:
        room = Path(place)
        (room / "logs").symlink_to(LOG.parent)
        for name, text in FILES.items():
            (room / name).write_text(text, encoding="utf-8")
        for example in EXAMPLES:
            lines = _printed(example.words, room)
            for name, parts in example.parts.items():
                yield f"{name}.txt", shown(example.words, lines, parts)


def shown(words: str, lines: Sequence[str], parts: Sequence[Part]) -> str:
    """The command line, and the parts of its output."""
    told = "\n[...]\n".join("\n".join(_cut(lines, part)).strip("\n") for part in parts)
    lead = "[...]\n" if parts[0].begins else ""
    trail = "\n[...]" if parts[-1].until else ""
    return f"$ advisor {words}\n{lead}{told}{trail}\n"


def _cut(lines: Sequence[str], part: Part) -> Sequence[str]:
    """The lines of a part.

    Raises
    ------
    ValueError
        The output has no such line.
    """
    places = [n for n, line in enumerate(lines) if line.startswith(part.begins)]
    if not places:
        raise ValueError(
            f"no line begins with {part.begins!r}: name another one in benchmarks/pages/example.py"
        )
    ends = [n for n, line in enumerate(lines) if n > places[0] and line.startswith(part.until)]
    if part.until and not ends:
        raise ValueError(
            f"no line begins with {part.until!r}: name another end in benchmarks/pages/example.py"
        )
    return lines[places[0] : ends[0] if part.until else len(lines)]


def _printed(words: str, room: Path) -> Sequence[str]:
    """What a command prints on 80 columns, line by line."""
    command = [sys.executable, "-m", "advisor", *words.split()]
    inside = {**os.environ, "COLUMNS": "80", "PYTHONIOENCODING": "utf-8", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=room, env=inside, capture_output=True, encoding="utf-8", check=False)
    return [line.rstrip() for line in done.stdout.splitlines()]


def figures() -> Iterator[tuple[str, str]]:
    """Yield the name and the SVG of every figure, after estimating and diagnosing."""
    aircraft = load_aircraft(AIRCRAFT)
    maneuver = read(LOG, aircraft).maneuvers[_SHOWN]
    found = estimate(maneuver, aircraft)
    assert isinstance(found, Estimate), found.text
    yield "maneuver.svg", svg(stages(maneuver))
    yield "model.svg", svg(response(maneuver, found))
    yield "output-error.svg", svg(residuals(maneuver, found))
    yield "gap.svg", svg(errors(compare_logs([LOG], aircraft).diagnosis))
