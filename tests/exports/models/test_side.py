"""Roll and yaw in MATLAB's and JSBSim's formats, read back by Octave and by JSBSim itself."""

import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.decision.axes.lateral_requirements import peak_roll_rate
from advisor.exports.models.flown import FlownModel, side_of
from advisor.exports.models.formats.jsbsim_format import FORMAT as JSBSIM
from advisor.exports.models.formats.matlab_format import both_axes_text, matrices
from advisor.exports.models.improvement import STILL_AIR, ExportedServo
from advisor.exports.models.jsbsim.axes.side_text import side_text
from advisor.exports.models.jsbsim.slopes import Request
from advisor.exports.models.jsbsim.source import measure, measure_side, model_of
from advisor.gap.result import Value
from advisor.model.axes.lateral import Trim, state_matrix
from advisor.words.problems import ConfigurationError
from tests.campaign.side_builders import estimate
from tests.exports.models.cases import air_at, improvement
from tests.exports.models.test_jsbsim import placed, trimmed
from tests.exports.models.test_matlab import OCTAVE, needs_octave
from tests.oem.axis.builders import JET

JET_SIDE = side_of(estimate("aileron", "rudder"), Trim(130.0, 0.07, 0.105), STILL_AIR, Aircraft())
ASKED = Request(53.0, 1000.0, powered=False, sideways=True)
CESSNA = model_of("c172p")
OWN = CESSNA.file.read_bytes()


@needs_octave
def test_octave_has_both_axes_and_the_modes_of_the_estimate(tmp_path):
    script = tmp_path / "model.m"
    script.write_text(both_axes_text(FlownModel(Aircraft("jet"), improvement(), JET_SIDE)).text)
    shown = "size(A), lateral.B(:), sort(abs(eig(lateral.A))), lateral.D(4, 2)"
    code = f"run('{script}'); printf('%.12g\\n', {shown});"
    assert OCTAVE is not None
    said = subprocess.run(
        [OCTAVE, "--norc", "--quiet", "--eval", code], capture_output=True, text=True, check=True
    )
    found = [float(line) for line in said.stdout.split()]
    a, b, _, _ = matrices(JET_SIDE)
    expected = [2, 2, *b.T.ravel(), *sorted(abs(np.linalg.eigvals(a))), 130.0 * JET["Y_delta_r"]]
    assert found == pytest.approx(expected, rel=1e-6)


def test_a_derivative_that_is_not_identifiable_has_its_reason_in_the_place_of_a_number():
    found = estimate("aileron", untold={"Y_p": "fly a rudder doublet"})
    untold = side_of(found, JET_SIDE.trim, STILL_AIR, Aircraft())
    text = both_axes_text(FlownModel(Aircraft("jet"), None, untold)).text
    assert "% Y_p is not identifiable: fly a rudder doublet" in text
    assert "parameters.Y_p" not in text
    assert "lateral.parameters.L_p.value = -2.1;  % 1/s" in text


@pytest.fixture(scope="module")
def cessna():
    """Slopes of the unchanged Cessna at 53 m/s."""
    return measure_side(CESSNA.file.read_bytes(), CESSNA, ASKED)


def believed(own, **factors):
    """Return a lateral model that differs from the Cessna by factors, sure of each derivative."""
    theta = np.array(
        [
            own.derivatives[name] * own.signs.get(name[2:], 1.0) * factors.get(name, 1.0)
            for name in SIDE_PARAMETERS
        ]
    )
    found = estimate("aileron", "rudder")
    covariance = np.diag((1e-3 * np.maximum(np.abs(theta), 1e-3)) ** 2)
    told = replace(found, theta=theta, covariance=covariance, airspeed_m_s=ASKED.airspeed_m_s)
    trim = Trim(ASKED.airspeed_m_s, 0.03, 0.03)
    return side_of(told, trim, air_at(ASKED.height_m), Aircraft())


CHANGED = {
    "L_p": 0.6,
    "L_delta_a": 1.3,
    "N_beta": 1.5,
    "N_r": 1.4,
    "L_beta": 0.5,
    "Y_beta": 1.2,
    "N_delta_r": 0.7,
}


@pytest.fixture(scope="module")
def corrected(cessna):
    return side_text("Cessna", believed(cessna, **CHANGED), CESSNA, OWN)


def test_measured_again_each_derivative_is_that_of_the_estimate(cessna, corrected):
    again = measure_side(corrected.text.encode(), CESSNA, ASKED).derivatives
    for name in SIDE_PARAMETERS:
        own = cessna.derivatives[name]
        size = max(abs(own), 0.02 * abs(cessna.derivatives[f"{name[0]}_beta"]))
        assert again[name] == pytest.approx(own * CHANGED.get(name, 1.0), abs=5e-3 * size), name


def test_the_exported_aircraft_rolls_as_the_estimate_does(cessna, corrected, tmp_path):
    side = believed(cessna, **CHANGED)
    rate, aileron = _rolled(placed(corrected.text, tmp_path, "c172p"))
    theta = side.numbers
    expected = peak_roll_rate(theta, state_matrix(theta, side.trim), cessna.signs["delta_a"] * aileron, 1.0)
    unchanged, _ = _rolled(CESSNA.file)
    assert rate == pytest.approx(expected, rel=0.03)
    assert abs(unchanged - expected) > 0.15 * abs(expected)


def _rolled(file: Path) -> tuple[float, float]:
    """Return the largest change of the roll rate within a second of aileron, rad/s, and the aileron, rad."""
    fdm = trimmed(file, ASKED.airspeed_m_s)
    before, rates = fdm["velocities/p-rad_sec"], []
    neutral = fdm["fcs/left-aileron-pos-rad"]
    fdm["fcs/aileron-cmd-norm"] += 0.3
    for _ in range(240):
        fdm.run()
        rates.append(fdm["velocities/p-rad_sec"] - before)
    return float(max(rates, key=abs)), float(fdm["fcs/left-aileron-pos-rad"]) - neutral


def test_both_axes_are_corrected_in_one_aircraft(cessna, tmp_path):
    side = believed(cessna, L_p=0.6)
    own = measure_pitch(OWN)
    pitch = improvement(
        model={n: Value((0.6 if n == "M_alpha" else 1.0) * x, 1e-3 * abs(x) + 1e-6) for n, x in own.items()},
        prior=own, airspeed_m_s=ASKED.airspeed_m_s, air=air_at(ASKED.height_m), servo=ExportedServo(),
    )  # fmt: skip
    aircraft = Aircraft("Cessna", simulator="jsbsim:c172p")
    made = JSBSIM.made(FlownModel(aircraft, pitch, side), tmp_path / "x.xml").text.encode()
    again = measure_side(made, CESSNA, ASKED).derivatives
    assert again["L_p"] == pytest.approx(0.6 * cessna.derivatives["L_p"], rel=0.02)
    assert measure_pitch(made)["M_alpha"] == pytest.approx(0.6 * own["M_alpha"], rel=0.02)


def measure_pitch(content):
    """Return the derivatives of pitch of a content, with an elevator in rad, and constants of zero."""
    asked = Request(ASKED.airspeed_m_s, ASKED.height_m)
    return {"Z_0": 0.0, "M_0": 0.0} | dict(measure(content, CESSNA, asked).derivatives)


def test_a_derivative_that_is_not_told_from_zero_becomes_zero_and_is_said(cessna):
    side = believed(cessna)
    unsure = {"N_p": Value(0.05 * side.values["L_p"].value, abs(side.values["L_p"].value))}
    unsure["N_r"] = Value(0.2 * side.values["N_r"].value, 0.2 * abs(side.values["N_r"].value))
    made = side_text("Cessna", replace(side, values=side.values | unsure), CESSNA, OWN)
    assert "N_r, which is not distinguished from zero and is 0" in made.left_out
    assert not any(one.startswith("N_p") for one in made.left_out)  # the aircraft's own value lies within
    again = measure_side(made.text.encode(), CESSNA, ASKED).derivatives
    assert again["N_r"] == pytest.approx(0.0, abs=5e-3 * abs(cessna.derivatives["N_r"]))


def test_what_the_interval_holds_is_left_as_the_aircraft_has_it(cessna):
    assert "aero/advisor" not in side_text("Cessna", believed(cessna), CESSNA, OWN).text


def test_an_aircraft_without_an_axis_of_roll_is_refused(tmp_path):
    plain = CESSNA.file.read_text().replace('name="ROLL"', 'name="SWAY"')
    own = replace(CESSNA, file=placed(plain, tmp_path, "c172p"))
    with pytest.raises(ConfigurationError, match="no axis ROLL"):
        side_text("Cessna", JET_SIDE, own, own.file.read_bytes())
