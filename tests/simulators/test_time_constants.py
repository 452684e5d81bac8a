"""A lag of known size in a user's simulator, seen through each adapter."""

import re
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.simulators.around import lagging
from advisor.simulators.fmu import FmuSimulator
from advisor.simulators.jsbsim import make_jsbsim
from advisor.simulators.jsbsim_model import find_model
from advisor.simulators.protocol import Condition, Inputs, Replay, Simulator
from advisor.simulators.specification import make_python
from tests.simulators.test_fmu import NAMES

pytest.importorskip("jsbsim")
pytest.importorskip("fmpy")
LAG_S = 0.1
T = 0.005 * (np.arange(400) + 0.5)
STEP = Inputs(T, np.where(T > 0.5, 0.005, 0.0))


def of_python(folder: Path, lags: bool) -> tuple[Simulator, Condition]:
    factory = "make_slow" if lags else "make"
    return make_python(f"tests.simulators.nonlinear:{factory}", Aircraft()), Condition(25.0, 300.0)


def of_fmu(folder: Path, lags: bool) -> tuple[Simulator, Condition]:
    from tests.simulators.small_fmu import build

    file = build(folder, 2, lag_s=LAG_S if lags else None)
    return FmuSimulator(file, NAMES, 15.0), Condition(30.0, 500.0)


def of_jsbsim(folder: Path, lags: bool) -> tuple[Simulator, Condition]:
    text = find_model("c172p").read_text()
    if lags:
        text = re.sub(
            r"<output>fcs/elevator-pos-rad</output>\s*</aerosurface_scale>",
            "<output>fcs/asked</output></aerosurface_scale><lag_filter name='slow'><input>fcs/asked</input>"
            f"<c1>{1.0 / LAG_S}</c1><output>fcs/elevator-pos-rad</output></lag_filter>",
            text,
        )
    path = folder / "mine.xml"
    path.write_text(text)
    return make_jsbsim(str(path), Aircraft()), Condition(50.0, 1000.0)


def flown(simulator: Simulator, condition: Condition) -> Replay:
    try:
        return simulator.replay(condition, STEP)
    finally:
        simulator.close()


@pytest.mark.parametrize("of", [of_python, of_fmu, of_jsbsim])
def test_a_lag_in_the_users_simulator_keeps_its_time_constant(of, tmp_path):
    quick, slow = (flown(*of(tmp_path, lags)) for lags in (False, True))
    h = float(quick.t[1] - quick.t[0])
    # A linear aircraft behind a lag answers as its own answer behind that lag.
    sizes = np.arange(0.5, 1.5, 0.01) * LAG_S
    misses = [float(np.std(lagging(quick.q, h, size) - slow.q)) for size in sizes]
    assert sizes[int(np.argmin(misses))] == pytest.approx(LAG_S, rel=0.03)
    assert min(misses) < 0.01 * np.ptp(slow.q)
