"""The simulation takes the places of its numbers from the layout, and refuses a layout of another kind."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from advisor.gap.simulator.layout import DISTURBED, ENTRIES, LAYOUT, READ, SLOW, TRIM, key_of, places
from advisor.gap.simulator.pack import LANES
from advisor.gap.simulator.simulate import simulate
from advisor.gap.simulator.surface import surfaces

ROOT = Path(__file__).parents[2]
SENTENCE = "^The simulation was compiled for another list of numbers: delete its compiled files, __pycache__"
N = 4
MOVED = key_of(places((*ENTRIES[1:], ENTRIES[0])), READ, SLOW, DISTURBED, TRIM)

_FLY = """
import numpy as np
from advisor.gap.simulator.layout import ENTRIES, INDEX, LAYOUT
from advisor.gap.simulator.pack import LANES
from advisor.gap.simulator.simulate import simulate
from advisor.gap.simulator.surface import surfaces

p = np.zeros((1, len(ENTRIES)))
for place, name in enumerate(sorted(ENTRIES)):
    p[0, INDEX[name]] = 0.01 + 0.001 * place
t, u, n = np.array([0.0, 0.02, 0.04]), np.array([0.0, 0.1, -0.1]), 20
moved = surfaces(LAYOUT, 0.005, n, t, u, False, 0.0, p)
slow = np.full((10, n), 20.0)
flown = simulate(LAYOUT, 0.005, *moved, LANES, slow, np.zeros((4, 0)), np.zeros(1), np.ones(4), p)
print(ENTRIES[0], flown[0, :, :, 0].tolist())
"""


def test_a_surface_compiled_for_another_layout_refuses_to_move() -> None:
    with pytest.raises(ValueError, match=SENTENCE):
        _surface(MOVED, len(ENTRIES))


def test_a_simulation_compiled_for_another_layout_refuses_to_fly() -> None:
    with pytest.raises(ValueError, match=SENTENCE):
        _simulate(MOVED, len(ENTRIES))


def test_numbers_of_another_count_are_refused() -> None:
    with pytest.raises(ValueError, match=SENTENCE):
        _surface(LAYOUT, len(ENTRIES) - 1)
    with pytest.raises(ValueError, match=SENTENCE):
        _simulate(LAYOUT, len(ENTRIES) + 1)


def test_the_flown_layout_is_accepted() -> None:
    _surface(LAYOUT, len(ENTRIES))
    assert np.all(np.isfinite(_simulate(LAYOUT, len(ENTRIES))))


def test_a_flight_is_the_same_whatever_the_order_of_the_effects_numbers(tmp_path: Path) -> None:
    layout = Path("advisor") / "gap" / "simulator" / "layout.py"
    shutil.copytree(ROOT / "advisor", tmp_path / "advisor", ignore=shutil.ignore_patterns("__pycache__"))
    text = (ROOT / layout).read_text(encoding="utf-8")
    turned = text.replace("(*DERIVATIVES, *NUISANCES, *EFFECT_ENTRIES)", "(*EFFECT_ENTRIES[::-1], *NUISANCES, *DERIVATIVES)")  # fmt: skip  # noqa: E501
    (tmp_path / layout).write_text(turned, encoding="utf-8")
    first, flown = _fly(ROOT)
    other_first, other_flown = _fly(tmp_path)
    assert first != other_first
    assert flown == other_flown
    assert "nan" not in flown


def _surface(layout: int, numbers: int) -> None:
    t, u = np.array([0.0, 0.1]), np.zeros(2)
    surfaces(layout, 0.005, N, t, u, False, 0.0, np.zeros((1, numbers)))


def _simulate(layout: int, numbers: int) -> np.ndarray:
    still, none, trim = np.zeros((1, 2, N)), np.zeros((4, 0)), np.array([0.0, 0.0, 20.0, 1.0])
    slow, moved, p = np.full((len(SLOW), N), 20.0), np.zeros(1, dtype=np.int64), np.zeros((1, numbers))
    return simulate(layout, 0.005, still, moved, LANES, slow, none, np.zeros(1), trim, p)


def _fly(root: Path) -> tuple[str, str]:
    """Return the layout's first name, and a flight with numbers given by name, as text; without compiling."""
    plain = {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join([str(root), str(ROOT)])}
    run = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", _FLY],
        capture_output=True, text=True, check=True, env={**os.environ, **plain}, cwd=root,
    )  # fmt: skip
    first, flown = run.stdout.split(" ", 1)
    return first, flown
