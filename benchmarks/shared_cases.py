"""Run ``advisor analyze`` on every log of ../shared/cases, and compare with ``tests/shared_cases.yaml``.

A listed cause is asked of ``advisor gap`` of roll and yaw.
Prints a line for each log. Ends with 1 where a case fails that the list does not call open, or where a log
ends with another exit code than 0 or 3.
"""

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

from advisor.process.yaml_file import read_yaml

ROOT = Path(__file__).parent.parent
LISTED = ROOT / "tests" / "shared_cases.yaml"
ENDINGS = (".tlog", ".bin", ".ulg", ".log")
GAP = ("gap", "--axis", "lateral")
CLOSE = 0.05
"""Share of M_alpha by which a case may differ from its twin where the list gives no other."""


def answer(
    folder: Path, log: str, aircraft: str | None, asked: Sequence[str] = ("analyze",)
) -> tuple[int, dict[str, Any], str]:
    """Return exit code, document, and the answer as text."""
    given = ["--aircraft", str(folder / aircraft)] if aircraft else []
    program = "from advisor.start import main; main()"
    command = [sys.executable, "-c", program, *asked, str(folder / log), "--json", *given]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        return done.returncode, json.loads(done.stdout), done.stdout
    except ValueError:
        return done.returncode, {}, done.stderr


def accepted(maneuvers: Any) -> list[dict[str, Any]]:
    """Return the accepted manoeuvres of a block. A gap lists the numbers of its manoeuvres alone."""
    return [m for m in maneuvers or [] if isinstance(m, dict) and m["verdict"] == "accepted"]


def values_of(document: Mapping[str, Any], name: str) -> list[float]:
    """Return the values of a derivative in the accepted manoeuvres of both axes."""
    lateral = document.get("lateral") or {}
    both = [*accepted(document.get("maneuvers")), *accepted(lateral.get("maneuvers"))]
    found = [(m.get("estimates") or {}).get(name) for m in both]
    return [one["value"] for one in found if one and one["value"] is not None]


def lacking(case: Mapping[str, Any], document: dict[str, Any], text: str, twin: Any) -> Iterator[str]:
    """Yield a sentence for everything in which an answer differs from the list."""
    pitch = accepted(document.get("maneuvers"))
    lateral = accepted((document.get("lateral") or {}).get("maneuvers"))
    for key, found in (("accepted", pitch), ("lateral", lateral)):
        if key in case and len(found) != case[key]:
            yield f"{len(found)} {key}, not {case[key]}"
    if "says" in case and case["says"] not in text:
        yield f"does not say {case['says']!r}"
    for name, (value, tolerance) in case.get("near", {}).items():
        if not any(abs(one - value) <= tolerance for one in values_of(document, name)):
            yield f"{name} {values_of(document, name)}, not {value}"
    causes = (document.get("lateral") or {}).get("causes") or []
    sizes = {one["name"]: next(iter(one["parameters"].values()))["value"] for one in causes if one["present"]}
    for name, (value, tolerance) in case.get("cause", {}).items():
        if name not in sizes or abs(sizes[name] - value) > tolerance:
            yield f"causes {sizes}, not {name} {value}"
    if twin is not None:
        mine, his = (values_of(one, "M_alpha") for one in (document, twin))
        within = case.get("within", CLOSE)
        if not his or not any(abs(one - his[0]) <= within * abs(his[0]) for one in mine):
            yield f"M_alpha {mine}, the twin has {his}"


def main() -> int:
    """Run all cases; return the exit code."""
    folder = ROOT.parent / "shared" / "cases"
    if not folder.is_dir():
        print("../shared/cases is not there")
        return 0
    listed = read_yaml(LISTED)
    assert isinstance(listed, dict)
    asked = sys.argv[1:] or sorted(p.name for p in folder.iterdir() if p.suffix in ENDINGS)
    once = cache(lambda log, aircraft, *asked: answer(folder, log, aircraft, asked or ("analyze",)))

    def run(log: str) -> tuple[str, bool]:
        case = listed.get(log, {})
        twin = once(case["like"], _of_twin(case))[1] if "like" in case else None
        code, document, text = once(log, case.get("aircraft"), *(GAP if "cause" in case else ()))
        wrong = [*([] if code in (0, 3) else [f"exit code {code}"]), *lacking(case, document, text, twin)]
        state = ("open" if "open" in case else "FAIL") if wrong else "ok"
        return f"{state:5s}{log}: {'; '.join(wrong) or 'as listed'}", state != "FAIL"

    with ThreadPoolExecutor(2) as pool:
        held = []
        for line, holds in pool.map(run, asked):
            print(line, flush=True)
            held.append(holds)
    print(f"{sum(held)} of {len(held)} as listed")
    return 0 if all(held) else 1


def _of_twin(case: Mapping[str, Any]) -> str | None:
    """Return the aircraft file of the twin: PX4's twins need one."""
    return "el2.yaml" if case["like"] == "u_base.ulg" else None


if __name__ == "__main__":
    sys.exit(main())
