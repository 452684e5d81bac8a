"""An export is read back by its own program, flown, and asked again: nothing is missing any more."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap import compare_logs
from advisor.exports.models.flown import improved_model
from advisor.exports.models.formats.matlab_format import script_text
from advisor.exports.models.write import carry_out, order_of
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition, Inputs
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import Maneuver, Scenario
from tests.exports.models.cases import improvement

OCTAVE = shutil.which("octave-cli")
SIX = tuple(Maneuver(name) for name in ("3211", "rev", "doublet", "3211", "rev", "doublet"))


@pytest.mark.skipif(OCTAVE is None, reason="octave-cli is not installed on this machine")
def test_the_script_flown_by_octave_moves_as_the_model_found(tmp_path: Path) -> None:
    improved = improvement()
    script = tmp_path / "model.m"
    script.write_text(script_text(improved).text)
    seconds = (0.1, 0.25, 0.5)
    # The answer to a step of the elevator, x = A⁻¹ (exp(A t) - 1) B.
    asked = "; ".join(f"A \\ ((expm(A * {t}) - eye(2)) * B)" for t in seconds)
    code = f"run('{script}'); printf('%.12g\\n', [{asked}]);"
    assert OCTAVE is not None
    done = subprocess.run(
        [OCTAVE, "--norc", "--quiet", "--eval", code], capture_output=True, text=True, timeout=60, check=True
    )
    flown = np.array(done.stdout.split(), float).reshape(len(seconds), 2)
    numbers = {name: improved.model[name].value for name in DERIVATIVES}
    t, step = 0.001 * (np.arange(600) + 0.5), 1e-5
    own = LinearSimulator(numbers).replay(Condition(improved.airspeed_m_s), Inputs(t, np.full(600, step)))
    for (alpha, q), at in zip(flown, seconds, strict=True):
        assert np.interp(at, own.t, own.alpha) / step == pytest.approx(alpha, rel=0.01)
        assert np.interp(at, own.t, own.q) / step == pytest.approx(q, rel=0.01)


@pytest.mark.study
def test_a_corrected_jsbsim_aircraft_flown_by_jsbsim_shows_no_gap(tmp_path: Path) -> None:
    pytest.importorskip("jsbsim")
    log, file = tmp_path / "flight.tlog", tmp_path / "better" / "c172p.xml"
    file.parent.mkdir()
    scenario = Scenario(
        aircraft="c172p", engine="jsbsim", seed=6, height_m=600.0, speed="free", maneuvers=SIX,
        effects={"transport_delay": {"delay_s": 0.06}},
    )  # fmt: skip
    record(flight_of(scenario), log)

    def asked(model: str):
        return compare_logs([log], Aircraft(simulator=f"jsbsim:{model}"))

    first = asked("c172p")
    assert first.diagnosis.causes[0].effect == "transport_delay"
    given = replace(first.aircraft, simulator="jsbsim:c172p", elevator=Aircraft().elevator)
    (outcome,) = carry_out([order_of(f"jsbsim:{file}")], improved_model(first.diagnosis, given, None))
    assert outcome.problem == ""
    again = asked(str(file)).diagnosis
    assert again.verdict == "none"
    assert again.in_simulator.before < 0.05 * first.diagnosis.in_simulator.before
