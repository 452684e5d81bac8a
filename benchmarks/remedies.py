"""Run ``advisor analyze`` on real and recorded flights, and look for advice that contradicts itself.

A verdict has one remedy: that of its first reason. No verdict asks for a smaller and a larger input. No
number of a sentence has an exponent. Prints each verdict that breaks a rule, and then ends with 1.
"""

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.shared_cases import ROOT, answer

ENDINGS = (".tlog", ".bin", ".BIN", ".ulg")
_SMALLER = re.compile(r"smaller steps|less stick|less aileron|less elevator|no larger steps")
_LARGER = re.compile(r"times the (?:stick|aileron|rudder)|more (?:of the )?(?:stick|aileron|rudder)")
_EXPONENT = re.compile(r"\d[eE][+-]\d")


def contradictions(verdict: Mapping[str, Any]) -> Iterator[str]:
    """Yield a sentence for each rule that a manoeuvre's verdict of the document breaks."""
    reasons = [reason["text"] for reason in verdict.get("reasons", [])]
    texts = [str(verdict.get("sentence", "")), *reasons, *verdict.get("cautions", [])]
    whole = " | ".join(texts)
    remedies = sum("; " in text for text in reasons)
    if remedies > 1:
        yield f"{remedies} remedies: {whole}"
    if _SMALLER.search(whole) and _LARGER.search(whole):
        yield f"smaller and larger: {whole}"
    if _EXPONENT.search(whole):
        yield f"an exponent: {whole}"


def verdicts_of(document: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    """Return the judged manoeuvres of both axes in a document."""
    lateral = document.get("lateral") or {}
    flown = [*(document.get("maneuvers") or []), *(lateral.get("maneuvers") or [])]
    return [one for one in flown if isinstance(one, Mapping) and "verdict" in one]


def main() -> int:
    """Examine all flights, or those named; return the exit code."""
    folders = [ROOT / "logs", ROOT.parent / "shared" / "flights"]
    logs = [Path(name) for name in sys.argv[1:]]
    logs = logs or sorted(p for f in folders if f.is_dir() for p in f.iterdir() if p.suffix in ENDINGS)
    broken = count = 0
    for log in logs:
        file = log.with_suffix(".yaml")
        _, document, _ = answer(log.parent, log.name, file.name if file.is_file() else None)
        for verdict in verdicts_of(document):
            count += 1
            for said in contradictions(verdict):
                broken += 1
                print(f"{log.name}: {said}", flush=True)
    print(f"{count} verdicts of {len(logs)} logs, {broken} contradict themselves")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
