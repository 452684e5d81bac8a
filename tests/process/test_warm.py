"""What ``make setup`` compiles is all that a user's command needs."""

import subprocess
import sys
from pathlib import Path

from tests.flights import FOUR, recorded

# In a process of its own: other tests call the same kernels with arrays of their own.
_NEW_AFTER_WARMING = """
import gc, io, sys
from contextlib import redirect_stdout
from numba.core.dispatcher import Dispatcher
from advisor.cli.group import advisor
from advisor.gap.precompile import warm_up as gap
from advisor.mavlink.logs.precompile import warm_up as mavlink
from advisor.oem.precompile import warm as oem

def compiled():
    return {f"{d.py_func.__module__}.{d.__name__}{s}" for d in gc.get_objects() if isinstance(d, Dispatcher)
            and d.py_func.__module__.startswith("advisor") for s in d.signatures}

mavlink(), oem(), gap()
before = compiled()
for command in ("analyze", "doctor", "gap"):
    with redirect_stdout(io.StringIO()):
        advisor([command, sys.argv[1], "--json"], standalone_mode=False)
print("\\n".join(sorted(compiled() - before)))
"""


def test_after_setup_no_command_compiles_anything_more(tmp_path: Path) -> None:
    log = recorded("uav", 1.0, maneuvers=FOUR[:3])  # two are diagnosed, and one is held out
    run = subprocess.run(
        [sys.executable, "-c", _NEW_AFTER_WARMING, str(log)],
        cwd=tmp_path, capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    assert run.stdout.split("\n") == ["", ""]
