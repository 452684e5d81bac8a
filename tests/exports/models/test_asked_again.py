"""An export is read back by its own program, flown, and asked again: nothing is missing any more."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap import compare_logs, named_simulator
from advisor.exports.models.improvement import improvement_of
from advisor.exports.models.matlab import script_text
from advisor.exports.models.write import carry_out, order_of
from advisor.simulators.compare import compare
from advisor.simulators.linear import LinearSimulator
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import Maneuver, Scenario
from tests.simulators.nonlinear import flown

OCTAVE = shutil.which("octave-cli")
MODEL = {"Z_alpha": -2.7, "Z_q": 0.0, "Z_delta_e": -0.15, "M_alpha": -23.0, "M_q": -3.4, "M_delta_e": -29.0}
SIX = tuple(Maneuver(name) for name in ("3211", "rev", "doublet", "3211", "rev", "doublet"))


class Late(LinearSimulator):
    """The linear aircraft behind a delay of 50 ms."""

    def replay(self, condition, inputs, increments=None):
        late = np.interp(inputs.t - 0.05, inputs.t, inputs.elevator)
        return super().replay(condition, replace(inputs, elevator=late), increments)


@pytest.mark.study
@pytest.mark.skipif(OCTAVE is None, reason="octave-cli is not installed on this machine")
def test_the_script_read_by_octave_flies_like_the_aircraft(tmp_path: Path) -> None:
    file = Aircraft(model={**MODEL, "M_alpha": -16.0}, reference_airspeed_m_s=26.0)
    flight = flown(Late(MODEL, 26.0), maneuvers=6)
    found = compare(flight, LinearSimulator(file.model, 26.0), file).diagnosis
    assert {cause.effect for cause in found.causes if cause.present} == {"transport_delay"}
    script = tmp_path / "model.m"
    script.write_text(script_text(improvement_of(found, file)).text)
    asked = "[A(:); B(:); servo.delay_s; servo.lag_s; V]"
    code = f"run('{script}'); printf('%.12g\\n', {asked});"
    done = subprocess.run(
        [OCTAVE, "--norc", "--quiet", "--eval", code], capture_output=True, text=True, timeout=60, check=True
    )
    z_alpha, m_alpha, z_q, m_q, z_delta, m_delta, delay, lag, speed = map(float, done.stdout.split())
    numbers = (z_alpha, z_q - 1.0, z_delta, m_alpha, m_q, m_delta)
    better = LinearSimulator(dict(zip(MODEL, numbers, strict=True)), speed)
    servo = replace(Aircraft().elevator, delay_s=delay, lag_s=lag or None)
    as_exported = Aircraft(model=better.derivatives, elevator=servo, reference_airspeed_m_s=speed)
    assert compare(flight, better, as_exported).diagnosis.verdict == "none"


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
        simulator = named_simulator(Aircraft(simulator=f"jsbsim:{model}"))
        try:
            return compare_logs([log], Aircraft(), simulator)
        finally:
            simulator.close()

    first = asked("c172p")
    assert first.diagnosis.causes[0].effect == "transport_delay"
    given = replace(first.aircraft, simulator="jsbsim:c172p", elevator=Aircraft().elevator)
    (outcome,) = carry_out([order_of(f"jsbsim:{file}")], first.diagnosis, given)
    assert outcome.problem == ""
    again = asked(str(file)).diagnosis
    assert again.verdict == "none"
    assert again.in_simulator.before < 0.05 * first.diagnosis.in_simulator.before
