"""Type every command of README, tutorial and how-to pages as a reader does, with an installed program.

    python -m benchmarks.typed [--program advisor] [--simulator MODULE] [--keep FOLDER]

Each command runs in a folder with the files that the pages name: a sample flight, or a simulated one where
the command asks for roll and yaw or for JSBSim's aircraft. Commands that wait for a link, a browser, an
assistant or a shell are listed and not run. The exit code is 1 where a command fails.
"""

import argparse
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import monotonic

ROOT = Path(__file__).parents[1]
PAGES = (ROOT / "README.md", ROOT / "docs" / "tutorial.md", *sorted((ROOT / "docs" / "how-to").glob("*.md")))
WAITS = ("serve", "live", "mcp", "completion", "udpin:", "tcp://", "replay")
"""Words of commands that wait for somebody or something else."""
WHOLE = """
reference: {mass_kg: 2.0, wing_area_m2: 0.45, chord_m: 0.24, span_m: 1.9, iyy_kg_m2: 0.11}
aileron: {output: 1, calibration: [[1100, 25.0], [1500, 0.0], [1900, -25.0]]}
rudder: {output: 4, calibration: [[1100, 20.0], [1500, 0.0], [1900, -20.0]]}
"""
"""What some exports need beyond the sample's aircraft file."""
ANSWERS = "\n" * 40
"""A reader who takes every proposal of a question."""
LONGEST_S = 300.0


def lines_of(page: Path) -> Iterator[str]:
    """Yield the commands of the advisor in the fenced blocks of a page, without comments."""
    blocks = re.findall(r"^```(?:sh|text)\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    for line in "\n".join(blocks).replace("\\\n", " ").splitlines():
        if told := re.match(r"(?:\$ )?(advisor [^#]*)", line):
            yield told[1].strip()


RECORDED = {"lateral": ["--plan", "lateral"], "c172p": ["--engine", "jsbsim", "--aircraft", "c172p"]}
"""Word of a command to the simulated flight that it needs. All other commands have the sample flight."""


def furnish(folder: Path, flight: Path) -> None:
    """Put the files into a folder that the pages name; the flight has several names."""
    folder.mkdir(parents=True)
    shutil.copytree(ROOT / "logs", folder / "logs")
    aircraft = (ROOT / "logs" / "arduplane-calm.yaml").read_text(encoding="utf-8") + WHOLE
    if flight.stem == "c172p":
        aircraft = "name: c172p\n"
    (folder / "my-aircraft.yaml").write_text(aircraft, encoding="utf-8")
    (folder / "fleet.yaml").write_text('"*": my-aircraft.yaml\n', encoding="utf-8")
    (folder / "flights").mkdir()
    for name in ("flight.tlog", "flights/one.tlog"):
        shutil.copy(flight, folder / name)
    for name in ("battery-1.tlog", "battery-2.tlog"):
        shutil.copy(ROOT / "logs" / "bundled-demo.tlog", folder / name)


def typed(line: str, program: str, folder: Path) -> tuple[int, float, str]:
    """Run a command line in a folder; return its exit code, the time it took, s, and its last line."""
    words = shlex.split(line.replace("battery-2.bin", "battery-2.tlog"))
    out = words[words.index(">") + 1] if ">" in words else None
    if out:
        words = words[: words.index(">")]
    began_s = monotonic()
    ran = subprocess.run(
        [program, *words[1:]],
        cwd=folder, input=ANSWERS, capture_output=True, text=True, timeout=LONGEST_S, check=False,
    )  # fmt: skip
    if out:
        (folder / out).write_text(ran.stdout, encoding="utf-8")
    said = (ran.stderr or ran.stdout).strip().splitlines()
    return ran.returncode, monotonic() - began_s, said[-1] if said else ""


def main() -> int:
    """Type all commands; return 1 where one fails."""
    asked = argparse.ArgumentParser(prog="python -m benchmarks.typed")
    asked.add_argument("--program", default=str(Path(sys.executable).with_name("advisor")))
    asked.add_argument("--simulator", default="sim", help="module that records the flight of roll and yaw")
    asked.add_argument("--keep", type=Path, help="folder for the files, which stay; else they are removed")
    given = asked.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory() as own:
        root = (given.keep or Path(own)).resolve()
        root.mkdir(parents=True, exist_ok=True)
        program = str(Path(given.program).absolute())
        python = Path(program).with_name("python")
        home = ROOT if given.simulator == "sim" else root  # so that a wheel's own modules run
        flights = {"sample": ROOT / "logs" / "arduplane-calm.tlog"}
        for word, options in RECORDED.items():
            flights[word] = root / f"{word}.tlog"
            record = [python, "-m", given.simulator, "record", *options, "--out", flights[word]]
            subprocess.run([*map(str, record)], check=True, capture_output=True, cwd=home)
        for page in PAGES:
            for word, flight in flights.items():
                furnish(root / page.stem / word, flight)
            for line in lines_of(page):
                if any(word in line for word in WAITS):
                    print(f"{'waits':>7}         {page.name}: {line}", flush=True)
                    continue
                folder = root / page.stem / next((word for word in RECORDED if word in line), "sample")
                if "-o my-aircraft.yaml" in line:
                    (folder / "my-aircraft.yaml").unlink()
                code, seconds, last = typed(line, program, folder)
                failed += code != 0
                print(f"{code:>7}{seconds:>7.1f} s {page.name}: {line}", flush=True)
                if code:
                    print(f"{'':>17}{last}", flush=True)
    print(f"{failed} failed")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
