"""The worked examples: a shipped log against a simulator without a servo lag, and a planned flight."""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from advisor.config import load_aircraft
from advisor.diagnosis import diagnose_logs
from advisor.gap.result import Diagnosis

LOG = Path(__file__).parents[2] / "logs" / "arduplane-calm.tlog"
AIRCRAFT = """name: arduplane
elevator: {output: 2, calibration: [[1000, 25.0], [1500, 0.0], [2000, -25.0]], lag_s: 0.0}
reference_airspeed_m_s: 26.1
model: {Z_0: 0.0, Z_alpha: -8.01, Z_q: -0.03, Z_delta_e: 0.79,
        M_0: 0.0, M_alpha: -48.3, M_q: -4.23, M_delta_e: -101.8}
"""
"""The derivatives of ``logs/README.md``, and a servo that follows at once."""
UAV = """name: uav
reference_airspeed_m_s: 22.0
model: {Z_0: 0.04, Z_alpha: -4.3, Z_q: -0.03, Z_delta_e: -0.28,
        M_0: 0.0, M_alpha: -37.0, M_q: -4.8, M_delta_e: -52.0}
"""
"""An aircraft that has not flown yet, for ``docs/foresee.md``."""


def diagnosis() -> Diagnosis:
    """The diagnosis of the example."""
    with TemporaryDirectory() as place:
        return diagnose_logs([LOG], load_aircraft(_written(Path(place), AIRCRAFT)))


def transcript() -> str:
    """File, command and output as Markdown; of the output the verdict, the place and the causes."""
    told = excerpt(_told(AIRCRAFT, "gap", str(LOG), "--aircraft", "aircraft.yaml"))
    return _shown(AIRCRAFT, f"advisor gap logs/{LOG.name} --aircraft aircraft.yaml", told)


def foresight() -> str:
    """The worked example of ``advisor gap --foresee``: command and whole output."""
    options = ("gap", "--foresee", "--aircraft", "aircraft.yaml")
    return _shown(UAV, f"advisor {' '.join(options)}", _told(UAV, *options).strip())


def _told(aircraft: str, *options: str) -> str:
    with TemporaryDirectory() as place:
        _written(Path(place), aircraft)
        command = [sys.executable, "-m", "advisor", *options]
        inside = {
            **os.environ,
            "COLUMNS": "80",
            "PYTHONIOENCODING": "utf-8",
            "PYTHONPATH": str(LOG.parents[1]),
        }
        done = subprocess.run(
            command, cwd=place, env=inside, capture_output=True, encoding="utf-8", check=True
        )
    return "\n".join(line.rstrip() for line in done.stdout.splitlines())


def _shown(aircraft: str, command: str, told: str) -> str:
    return f"```yaml\n{aircraft}```\n\n```text\n$ {command}\n{told}\n```"


def excerpt(output: str) -> str:
    """The first boxes of the output, up to the place of the gap, and the table of causes."""
    lines = output.splitlines()
    until = next(n for n, line in enumerate(lines) if "where in the flight" in line)
    begins = next(n for n, line in enumerate(lines) if line.startswith("cause "))
    ends = next(n for n, line in enumerate(lines) if n > begins and line.startswith("● part of"))
    return "\n".join([*lines[:until], "[...]", *lines[begins:ends]])


def _written(place: Path, aircraft: str) -> Path:
    path = place / "aircraft.yaml"
    path.write_text(aircraft, encoding="utf-8")
    return path
