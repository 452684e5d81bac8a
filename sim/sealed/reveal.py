"""Open the key of sealed cases, and print the score of the answers."""

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .judge import Judged, judge
from .score import Rate, by_effect, in_time, score
from .seal import SealError, unseal


def read_answers(path: Path) -> dict[str, dict[str, Any]]:
    """Read answers, one JSON object on each line: ``case`` and ``answer`` (or ``document``).

    Raises
    ------
    SealError
        A line is no object with these keys.
    """
    answers: dict[str, dict[str, Any]] = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        if not line.strip():
            continue
        try:
            said = json.loads(line)
            answers[str(said["case"])] = dict(said.get("answer") or said.get("document") or {})
        except (ValueError, KeyError, TypeError) as error:
            raise SealError(f"{path}:{number}: not a line of {{case, answer}}") from error
    return answers


def judge_all(folder: Path, answers: Path, key_file: Path) -> tuple[dict[str, Judged], int]:
    """Open the key, and return each judged case and the number of answered cases.

    Raises
    ------
    SealError
        The answers or the key differ from the committed ones, or an earlier version wrote the key.
    """
    said = read_answers(answers)
    key = unseal(folder, answers, key_file)
    if any("kind" not in truth for truth in key.values()):
        raise SealError(f"{key_file}: sealed by an earlier version; score it with that version")
    judged = {name: judge(truth, said.get(name, {})) for name, truth in key.items()}
    return judged, len(set(said) & set(key))


def report(folder: Path, answers: Path, key_file: Path, details: bool = False) -> Iterator[str]:
    """Yield the lines of the score table.

    Raises
    ------
    SealError
        The answers are not those committed, or the key is not the one sealed.
    """
    judged, answered = judge_all(folder, answers, key_file)
    yield f"{len(judged)} cases, {answered} answered; percent with 95 % intervals"
    for rate in (*score(list(judged.values())), in_time(_seconds_of(answers))):
        yield rate.line()
    if not details:
        return
    yield "right cause first, by effect"
    for rate in by_effect(list(judged.values())):
        yield rate.line()
    yield "not right"
    for name, j in judged.items():
        if not j.is_right:
            yield _wrong(name, j)


def _wrong(name: str, j: Judged) -> str:
    """Return the line about a wrong answer: the truth and the answer."""
    told = f"{j.verdict} {j.named[0] if j.named else ''}".strip()
    sizes = {effect: {k: round(v, 5) for k, v in own.items()} for effect, own in j.sizes.items()}
    gap = "" if j.gap is None else f" gap {j.gap:.2f}"
    truth = f"{name} {j.kind:10s} {j.condition:8s} {sizes or '-'}{gap}"
    return f"  {truth} -> {told} @ {j.block} p={j.probability:.2f}"


def score_document(folder: Path, answers: Path, key_file: Path) -> dict[str, Any]:
    """Return the score table as one JSON document, with the hash of the answers.

    Each figure has ``trials``. A share has ``hits``; any other figure has ``value`` in percent.

    Raises
    ------
    SealError
        The answers are not those committed, or the key is not the one sealed.
    """
    judged, answered = judge_all(folder, answers, key_file)
    rates = (*score(list(judged.values())), in_time(_seconds_of(answers)))
    return {
        "schema": "score/1",
        "cases": len(judged),
        "answered": answered,
        "answers_sha256": hashlib.sha256(answers.read_bytes()).hexdigest(),
        "figures": [_figure(rate) for rate in rates],
    }


def _figure(rate: Rate) -> dict[str, Any]:
    said: dict[str, Any] = {"name": rate.name.strip(), "trials": rate.count}
    if rate.hits is not None:
        said["hits"] = rate.hits
    elif rate.count:
        said["value"] = rate.value
    return said


def _seconds_of(answers: Path) -> list[float]:
    """Return the processor time of each answer that states one, s."""
    lines = (json.loads(line) for line in answers.read_text(encoding="utf-8").splitlines() if line.strip())
    return [float(line["cpu_s"]) for line in lines if line.get("cpu_s") is not None]
