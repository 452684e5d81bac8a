"""FMUs for model exchange: their states integrated through events, against the same C code with a solver."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("fmpy")

from advisor.simulators.fmu import FmuSimulator
from advisor.simulators.fmu_model_exchange import EndedError, ModelExchange
from advisor.simulators.protocol import Inputs, Replay
from tests.simulators.makeshift import Damping
from tests.simulators.small_fmu import build
from tests.simulators.test_fmu import DOUBLET, LEVEL, NAMES, T, assert_flown, both, exact


def flown(folder: Path, fmi: int, exchanges: bool = True, **model: float) -> Replay:
    folder = folder / str(exchanges)
    folder.mkdir()
    file = build(folder, fmi, exchanges=exchanges, **model)
    return FmuSimulator(file, NAMES, 15.0).replay(LEVEL, Inputs(T, DOUBLET))


@both
def test_the_states_are_trimmed_and_integrated_by_the_equations_of_the_fmu(tmp_path: Path, fmi: int) -> None:
    assert_flown(flown(tmp_path, fmi), *exact(DOUBLET, LEVEL), within=1e-3)


@both
def test_a_relay_and_a_timed_event_switch_where_the_fmus_own_solver_switches_them(
    tmp_path: Path, fmi: int
) -> None:
    plain, exchanged = flown(tmp_path, fmi, False, relay=0.8), flown(tmp_path, fmi, relay=0.8)
    assert np.ptp(np.sign(plain.theta - 0.29)) == 2.0
    # The FMU's own solver switches on a grid of 0.1 ms.
    assert_flown(exchanged, plain.alpha, plain.q, plain.theta, within=5e-3)
    without = exact(DOUBLET, LEVEL)[1]
    assert np.max(np.abs(plain.q - without)) > 0.2 * np.ptp(without)


def test_a_stiff_servo_is_integrated_as_well(tmp_path: Path) -> None:
    plain, exchanged = flown(tmp_path, 2, False, lag_s=0.002), flown(tmp_path, 2, lag_s=0.002)
    assert_flown(exchanged, plain.alpha, plain.q, plain.theta, within=2e-3)


def test_increments_enter_a_model_exchange_at_their_inputs(tmp_path: Path) -> None:
    fmu = FmuSimulator(build(tmp_path, 2, exchanges=True), NAMES, 15.0)
    damped = fmu.replay(LEVEL, Inputs(T, DOUBLET), Damping(-1.5))
    assert_flown(damped, *exact(DOUBLET, LEVEL, damping=-1.5), within=5e-3)


def restless(ends: bool) -> ModelExchange:
    """Return an FMU of one state that names the present as the time of its next event, or ends there."""
    now, still = [0.0], lambda *_: None
    updates = iter([(False, False), *[(False, ends)] * 1000])
    does_nothing = ("setContinuousStates", "getContinuousStates", "getDerivatives", "getEventIndicators",
                    "enterEventMode", "enterContinuousTimeMode")  # fmt: skip
    instance = SimpleNamespace(
        **dict.fromkeys(does_nothing, still),
        setTime=lambda t: now.__setitem__(0, t),
        newDiscreteStates=lambda: (*next(updates), False, False, True, now[0]),
    )
    kind = SimpleNamespace(needsCompletedIntegratorStep=False)
    described = SimpleNamespace(
        modelExchange=kind, fmiVersion="2.0", numberOfContinuousStates=1, numberOfEventIndicators=0
    )
    return ModelExchange(instance, described)


def test_an_fmu_that_switches_without_an_end_or_ends_itself_does_not_hang() -> None:
    with pytest.raises(RuntimeError, match="switches more than 100 times"):
        restless(ends=False).advance(0.0, 0.01)
    with pytest.raises(EndedError):
        restless(ends=True).advance(0.0, 0.01)
