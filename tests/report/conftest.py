"""One flight, its page and its documents, made once."""

import json
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from advisor.aircraft_file.read import load_aircraft
from advisor.cli import group as cli
from advisor.cli.options import LogsAsked
from advisor.cli.page_content import gather
from advisor.report.page.blocks import Content
from tests.flights import FOUR, TWO, recorded
from tests.recorded import use_recorded
from tests.report.page_reader import Page

AIRCRAFT = """
name: <paper> & "twin"
reference: {mass_kg: 9000.0, wing_area_m2: 33.0, chord_m: 2.9, iyy_kg_m2: 50000.0, cg_percent_chord: 24.0}
model: {Z_0: -0.009, Z_alpha: -0.483, Z_q: 0.104, Z_delta_e: 0.676, M_0: 0.475, M_alpha: -6.0, M_q: -2.01,
  M_delta_e: -7.21}
"""


@dataclass(frozen=True)
class Reported:
    """What the commands say of one flight of three manoeuvres."""

    log: Path
    short_log: Path
    aircraft: Path
    written: str
    """The page as ``advisor report --gap`` wrote it."""
    content: Content
    """What that page was written from, gathered again; the gap is what ``advisor gap`` says."""
    page: Page
    """The same, read."""
    analysis: dict[str, Any]
    gap: dict[str, Any]
    doctor: dict[str, Any]
    printed: dict[str, str]
    """What the commands print of the flight, by the command's name."""


def _caller(patch: pytest.MonkeyPatch) -> Callable[..., str]:
    def call(*words: object) -> str:
        patch.setattr("sys.argv", ["advisor", *map(str, words)])
        with redirect_stdout(StringIO()) as printed, pytest.raises(SystemExit) as ended:
            cli.main()
        assert ended.value.code == 0
        return printed.getvalue()

    return call


@pytest.fixture(scope="package")
def reported(tmp_path_factory: pytest.TempPathFactory) -> Reported:
    path = tmp_path_factory.mktemp("report") / "twin.yaml"
    path.write_text(AIRCRAFT, encoding="utf-8")
    return said_of(recorded("linear", 1.0, maneuvers=FOUR[:3]), path)


def said_of(log: Path, path: Path) -> Reported:
    """Return what the commands say of a log with an aircraft file; the page is written next to the file."""
    out = path.with_name("page.html")
    with pytest.MonkeyPatch.context() as patch:
        use_recorded(patch)
        patch.setenv("COLUMNS", "200")
        call = _caller(patch)
        asked = {name: (name, log, "--aircraft", path) for name in ("analyze", "gap", "doctor")}
        found = {name: json.loads(call(*words, "--json")) for name, words in asked.items()}
        printed = {name: call(*words) for name, words in asked.items()}
        call("report", log, "--aircraft", path, "--gap", "-o", out)
        content, _ = gather(LogsAsked((log,), path), load_aircraft(path), False)
    written = out.read_text(encoding="utf-8")
    return Reported(
        log, recorded("linear", 1.0, maneuvers=TWO[:1]), path, written, replace(content, gap=found["gap"]),
        Page.read(written), found["analyze"], found["gap"], found["doctor"], printed,
    )  # fmt: skip
