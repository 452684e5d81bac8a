"""`.ci/run` ends with the closing lines of the tests and of the gate, and fails with either."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAKE = '#!/bin/sh\n[ "$1" = test ] || exit 0\necho "5 passed"\nexit {code}\n'
"""A make whose tests print one line and end with a given exit code."""
GATE = '#!/bin/sh\necho "3 of 4 hold"\nexit {code}\n'


@pytest.mark.parametrize(
    ("tests", "gate", "passes"),
    [(0, 0, True), (0, None, True), (0, 1, False), (2, 0, False), (2, None, False)],
)
def test_both_the_tests_and_the_gate_decide(tmp_path, tests, gate, passes):
    checkout, programs = tmp_path / "checkout", tmp_path / "programs"
    (checkout / ".ci").mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "run", checkout / ".ci" / "run")
    program(programs / "make", MAKE.format(code=tests))
    program(programs / "apt-get", "#!/bin/sh\n")
    if gate is not None:
        program(tmp_path / "shared" / "gate" / "run", GATE.format(code=gate))
    environment = os.environ | {"PATH": f"{programs}:{os.environ['PATH']}"}
    command = ["bash", ".ci/run"]
    ended = subprocess.run(command, cwd=checkout, env=environment, capture_output=True, text=True, timeout=60)
    assert (ended.returncode == 0) is passes
    assert ended.stdout.splitlines() == ["5 passed", "3 of 4 hold"][: 1 if gate is None else 2]


def program(path: Path, text: str) -> None:
    """Write an executable script."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    path.chmod(0o755)
