"""Answer sealed cases of ``python -m sim blind`` with ``advisor gap``, from the logs alone.

    python -m sim blind --cases 300 --seed S --out cases
    python benchmarks/answer_sealed.py cases answers.jsonl
    python -m sim commit cases answers.jsonl
    python -m sim reveal cases answers.jsonl --details

Each case is answered by its own process, which is given a log and an aircraft file and nothing else. An
interrupted run goes on where it stopped.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def diagnose(case: Path) -> dict[str, object]:
    """Return the document of ``advisor gap --json`` for one case; empty when there is none."""
    with tempfile.TemporaryDirectory() as scratch:
        improved = str(Path(scratch) / "improved.yaml")
        command = [sys.executable, "-m", "advisor", "gap", str(case / "flight.tlog"), "--json"]
        command += ["--aircraft", str(case / "aircraft.yaml"), "--out", improved]
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    try:
        document: dict[str, object] = json.loads(done.stdout)
    except ValueError:
        print(f"{case.name}: exit {done.returncode}: {done.stderr.strip()[-200:]}", file=sys.stderr)
        return {}
    return document


def main() -> None:
    """Answer every case of a folder that has no answer yet."""
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    folder, answers = Path(sys.argv[1]), Path(sys.argv[2])
    names = sorted(path.name for path in folder.iterdir() if path.is_dir())
    answered = set()
    if answers.exists():
        answered = {json.loads(line)["case"] for line in answers.read_text(encoding="utf-8").splitlines()}
    with answers.open("a", encoding="utf-8") as out:
        for number, name in enumerate(names, start=1):
            if name in answered:
                continue
            began = time.monotonic()
            document = diagnose(folder / name)
            out.write(json.dumps({"case": name, "answer": document}) + "\n")
            out.flush()
            took = time.monotonic() - began
            print(f"{number}/{len(names)} {name} {document.get('verdict', 'no answer')} {took:.1f} s")


if __name__ == "__main__":
    main()
