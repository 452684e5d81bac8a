"""How often the diagnosis names what is true of an autopilot's own angle of attack: that it is late."""

import json
from pathlib import Path

from benchmarks.second_generator.case_files import key_file
from benchmarks.second_generator.score import Row, named

MADE_BY_AUTOPILOT = "alpha_made_by_autopilot"
TRUE_OF_IT = ("alpha_skew", "alpha_lag")


def line(folder: Path, answers: Path) -> str:
    """One row: the strict score counts these as wrong, though the lateness is in the log."""
    cases = json.loads(key_file(folder).read_text())["cases"]
    row = Row()
    for text in answers.read_text().splitlines():
        answer = json.loads(text)
        if MADE_BY_AUTOPILOT in cases[answer["case"]]["condition"]["troubles"]:
            row.add(named(answer["answer"]) in TRUE_OF_IT)
    return f"{'autopilot: its late angle of attack named first':<52}{row.text()}"
