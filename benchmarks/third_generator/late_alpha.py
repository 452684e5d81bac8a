"""How often the diagnosis names what is true of an autopilot's own angle of attack: that it is late."""

import json
from pathlib import Path

from benchmarks.second_generator.case_files import key_file
from benchmarks.second_generator.score import Row, named

MADE_BY_AUTOPILOT = "alpha_made_by_autopilot"
TRUE_OF_IT = ("alpha_skew", "alpha_lag")


def lines(folder: Path, answers: Path) -> str:
    """A row a class: the strict score counts these as wrong, though the lateness is in the log."""
    cases = json.loads(key_file(folder).read_text())["cases"]
    rows: dict[str, Row] = {}
    lines_read = [json.loads(text) for text in answers.read_text().splitlines() if text.strip()]
    given = {str(one["case"]): one["answer"] for one in lines_read}
    for name, case in cases.items():
        if name in given and MADE_BY_AUTOPILOT in case["condition"]["troubles"]:
            rows.setdefault(case["class"], Row()).add(named(given[name]) in TRUE_OF_IT)
    titles = {kind: f"autopilot, {kind}: its late alpha named first" for kind in sorted(rows)}
    return "\n".join(f"{title:<52}{rows[kind].text()}" for kind, title in titles.items())
