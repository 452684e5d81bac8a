"""Scored runs of the gap diagnosis: their data file, and the page ``validation/gap-results.md``."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from sim.sealed.score import HARD, wilson


@dataclass(frozen=True)
class Figure:
    """One figure of a score."""

    trials: int
    hits: int | None = None
    """Of a share."""
    value: float | None = None
    """Of a median or an error, in per cent."""


@dataclass(frozen=True)
class Run:
    """One set of flights, answered and scored."""

    set: str
    """Name of the set; several draws of one set have the same."""
    generator: str
    own: bool
    """Whether the flights come from the project's own simulator."""
    cases: int
    seed: int | None
    commit: str
    """Of the code that answered."""
    date: str
    hash: str
    """First digits of the SHA-256 of the answers; empty where none was kept."""
    figures: Mapping[str, Figure] = field(default_factory=dict)
    note: str = ""


@dataclass(frozen=True)
class Kind:
    """A kind of figure: its name on the page, its goal, and the row of the score that tells it."""

    title: str
    goal: str
    row: str = ""


FIGURES: Mapping[str, Kind] = {
    "cause": Kind("right cause first, one effect", "", "right cause first, one effect"),
    "cause_clean": Kind("– clean", "at least 98 %", "right cause first, clean"),
    "cause_hard": Kind("– hard", "at least 95 %", HARD),
    "cause_filtered": Kind("– filtered on the ground", "", "right cause first, filtered"),
    "cause_engine": Kind("– JSBSim", "at least 95 %", "right cause first, JSBSim"),
    "named_hard": Kind("a named cause is right, hard", "at least 98 %", "a named cause is right (hard)"),
    "alarm": Kind("false alarms where nothing is", "at most 1 %", "false alarms without an effect"),
    "parameters": Kind("wrong numbers diagnosed as such", "", "parameters told when only they are off"),
    "unknown": Kind("no named effect: unknown", "at least 90 %", "outside the catalogue: unknown"),
    "block": Kind("– in the right block", "at least 97 %", "outside the catalogue: right block"),
    "two": Kind("two effects: both named", "at least 90 %", "two effects: both named"),
    "size": Kind("size within its 95 % interval", "92 to 98 %", "size within its stated 95 % interval"),
    "again": Kind("improved file diagnosed again: none", ""),
    "fast": Kind("diagnosed within 5 s of CPU", "all", "CPU seconds at most 5"),
    "shrink_clean": Kind(
        "median held-out shrink, clean", "at least 97 %", "held-out shrink, right cause, clean (median %)"
    ),
    "shrink_hard": Kind(
        "median held-out shrink, hard", "at least 90 %", "held-out shrink, right cause, hard (median %)"
    ),
    "calibration": Kind(
        "expected calibration error", "at most 5 %", "expected calibration error of probabilities"
    ),
}
"""Every figure that a run may have, in the order of the page."""
_PARTS = ("cause_clean", "cause_hard", "cause_filtered", "cause_engine")
"""Shares of ``cause``."""
_COLUMNS = ("cause", "alarm", "parameters", "unknown", "block", "two", "size", "fast")


def read(path: Path) -> list[Run]:
    """The runs of a data file, in its order."""
    entries = json.loads(path.read_text(encoding="utf-8"))
    return [Run(**{**e, "figures": {k: Figure(**f) for k, f in e["figures"].items()}}) for e in entries]


def write(path: Path, runs: Sequence[Run]) -> None:
    """One run a line, so that a change shows as one."""
    lines = (json.dumps(_entry(run), ensure_ascii=False) for run in runs)
    path.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


def figures_of(score: Mapping[str, Any]) -> dict[str, Figure]:
    """The figures of a score's JSON that the page knows; rows without a case are left out."""
    by_row = {kind.row: name for name, kind in FIGURES.items()}
    found = {}
    for figure in score["figures"]:
        row = figure["name"]
        if row in by_row and figure["trials"]:
            found[by_row[row]] = Figure(figure["trials"], figure.get("hits"), figure.get("value"))
    return {name: found[name] for name in FIGURES if name in found}


def added(runs: Sequence[Run], run: Run) -> list[Run]:
    """The runs with one more, the newest first.

    Raises
    ------
    ValueError
        The run stands there already, or has no figure that the page knows.
    """
    if not run.figures:
        raise ValueError("the score has no figure that the page knows; give the JSON that a score printed")
    if any((r.set, r.seed, r.commit) == (run.set, run.seed, run.commit) for r in runs):
        raise ValueError(
            f"set {run.set}, seed {run.seed}, commit {run.commit} stands in the data file already"
        )
    return [run, *runs]


def newest(runs: Sequence[Run]) -> list[Run]:
    """The sealed sets that the newest commit answered: one state of the code, so they may be added."""
    sealed = [run for run in runs if run.hash]
    return [run for run in sealed if run.commit == sealed[0].commit]


def figures_table(runs: Sequence[Run]) -> str:
    """Every figure of the newest commit, over outside and over own sets, as Markdown, with the sets below."""
    whole = newest(runs)
    lines = ["| figure | outside generators | own sets | goal |", "|---|---|---|---|"]
    for name, kind in FIGURES.items():
        outside, own = (_of_all([r for r in whole if r.own is is_own], name) for is_own in (False, True))
        if outside or own:
            lines.append(f"| {kind.title} | {outside or '–'} | {own or '–'} | {kind.goal or '–'} |")
    return "\n".join([*lines, "", _source(whole)])


def _source(whole: Sequence[Run]) -> str:
    """The commit, the date and the sets of a run, with the hashes of the answers."""
    told = [f"{r.set} ({r.cases} flights, answers `{r.hash}`)" for r in whole]
    return f"Commit `{whole[0].commit}`, {whole[0].date}: {'; '.join(told)}."


def sets_table(runs: Sequence[Run]) -> str:
    """Every set of flights with its hits and trials, the outside ones first, as Markdown."""
    heads = (
        "set", "flights", "commit, date", "one cause", "alarms", "numbers", "unknown", "block", "two",
        "sizes", "5 s",
    )  # fmt: skip
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for is_own in (False, True):
        names = dict.fromkeys(r.set for r in runs if r.own is is_own)
        lines += [_row([r for r in runs if r.set == name and r.own is is_own]) for name in names]
    return "\n".join(lines)


def _entry(run: Run) -> dict[str, Any]:
    entry = asdict(run)
    entry["figures"] = {
        name: {key: value for key, value in asdict(figure).items() if value is not None}
        for name, figure in run.figures.items()
    }
    return entry


def _row(draws: Sequence[Run]) -> str:
    first = draws[0]
    cells = [
        first.set, str(sum(d.cases for d in draws)), f"{first.commit or '–'}, {first.date}",
        *(_cell(draws, name) for name in _COLUMNS),
    ]  # fmt: skip
    return f"| {' | '.join(cells)} |"


def _cell(draws: Sequence[Run], name: str) -> str:
    hits, trials = _sum(draws, name)
    shown = f"{hits}/{trials}" if trials else "–"
    parts = [(FIGURES[part].title.removeprefix("– "), _sum(draws, part)) for part in _PARTS]
    told = [f"{title} {h}/{n}" for title, (h, n) in parts if n]
    return f"{shown}: {', '.join(told)}" if name == "cause" and told else shown


def _sum(runs: Sequence[Run], name: str) -> tuple[int, int]:
    """Hits and trials; of ``cause`` the sum of its parts where a run does not say it."""
    hits = trials = 0
    for run in runs:
        names = _PARTS if name == "cause" and name not in run.figures else (name,)
        known = [f for f in (run.figures.get(n) for n in names) if f is not None and f.hits is not None]
        hits += sum(f.hits or 0 for f in known)
        trials += sum(f.trials for f in known)
    return hits, trials


def _of_all(runs: Sequence[Run], name: str) -> str:
    """A share over all runs with its interval, or the range of a value."""
    values = sorted(f.value for r in runs if (f := r.figures.get(name)) is not None and f.value is not None)
    if values:
        return f"{values[0]:.1f} to {values[-1]:.1f} %"
    hits, trials = _sum(runs, name)
    if not trials:
        return ""
    low, high = (100.0 * end for end in wilson(hits, trials))
    return f"{hits}/{trials}, {100.0 * hits / trials:.1f} % ({low:.0f}–{high:.0f})"
