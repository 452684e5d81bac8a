"""The wind of a flight: from its messages and records to every kind of simulator that takes a wind."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import FmuTrim
from advisor.flight.signals.channels import quantities
from advisor.flight.signals.derived_alpha import along_heading
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.record import Channel
from advisor.gap.records.prepare import prepare
from advisor.mavlink.logs.formats.dataflash import read_dataflash
from advisor.simulators.air import still_air_said, winds
from advisor.simulators.as_given import Flying
from advisor.simulators.isolated import Isolated
from advisor.simulators.protocol import Condition, Inputs
from advisor.simulators.stepped import Stepped
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight
from tests.mavlink.autopilot_logs import FORMATS, dataflash_record
from tests.mavlink.px4.test_px4_air import log as px4_log
from tests.mavlink.px4_logs import every
from tests.mavlink.px4_logs import flown as flown_by_px4
from tests.simulators.makeshift import Level
from tests.simulators.nonlinear import flown
from tests.simulators.test_air import Witness, at

T = 0.005 * (np.arange(400) + 0.5)
STEP = Inputs(T, np.where(T > 0.5, 0.005, 0.0))
BLOWN = Condition(50.0, 1000.0, wind_m_s=(-8.0, 5.0))
STILL = replace(BLOWN, wind_m_s=(0.0, 0.0))


def columns(name: str, **fields: list[float]) -> Columns:
    order = np.arange(len(next(iter(fields.values()))))
    return Columns(name, 1, 1, order, 1.0 * order, {k: np.array(v) for k, v in fields.items()}, "mavlink")


def decoded(message: Columns) -> dict[str, list[float]]:
    return {one.channel: one.y.tolist() for one in quantities(message, message.arrival_s)}


def test_a_wind_from_the_north_blows_to_the_south():
    found = decoded(columns("WIND", direction=[0.0, 90.0], speed=[8.0, 5.0]))
    assert found["wind_north"] == pytest.approx([-8.0, 0.0], abs=1e-12)
    assert found["wind_east"] == pytest.approx([0.0, -5.0], abs=1e-12)
    assert decoded(columns("WIND_COV", wind_x=[3.0], wind_y=[-2.0])) == {
        "wind_north": [3.0], "wind_east": [-2.0],
    }  # fmt: skip


def test_along_the_heading_a_wind_from_behind_is_positive_whatever_turn_the_heading_counts():
    t = np.arange(4.0)
    north, east = (Channel(name, t, np.full(4, y)) for name, y in (("wind_north", 0.0), ("wind_east", 6.0)))
    # The aircraft turns through south: east is then on its left, and on its right after north.
    heading = Channel("heading", t, np.radians([90.0, 179.0, -179.0, -90.0]))
    found = along_heading(north, east, heading)
    assert found["wind_along"].y == pytest.approx([6.0, 0.1047, -0.1047, -6.0], abs=1e-3)
    assert found["wind_right"].y == pytest.approx([0.0, -6.0, -6.0, 0.0], abs=1e-2)


def test_ardupilots_estimator_is_read_as_the_message_wind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    form = (17, "QBccccchhhhhh", "TimeUS,C,AX,AY,AZ,VWN,VWE,MN,ME,MD,MX,MY,MZ")
    monkeypatch.setitem(FORMATS, "XKF2", form)
    estimated = b"".join(
        dataflash_record("XKF2", 1_000_000 + 100_000 * k, 0, 0.0, 0.0, 0.0, 3.0, -4.0) for k in range(20)
    )
    path = tmp_path / "x.bin"
    path.write_bytes(dataflash_flight(3.0) + estimated)
    (batch,) = read_dataflash(path, {"WIND"})
    found = decoded(batch[0])
    assert found["wind_north"] == pytest.approx([3.0] * 20, abs=1e-5)
    assert found["wind_east"] == pytest.approx([-4.0] * 20, abs=1e-5)


@pytest.mark.parametrize("topic", ["wind", "wind_estimate"])
def test_the_wind_of_a_px4_log_reaches_its_manoeuvres(tmp_path: Path, topic: str):
    log = px4_log().topic(topic, every(1.0), windspeed_north=3.0, windspeed_east=-4.0)
    elevator = Elevator(output=2, calibration=((1000.0, 25.0), (2000.0, -25.0)))
    _, (one,), _ = flown_by_px4(log.write(tmp_path), Aircraft(elevator=elevator))
    along, right = winds([one.maneuver])[one.maneuver.number]
    assert np.hypot(along, right) == pytest.approx(5.0)


def test_the_wind_before_the_first_step_reaches_the_simulator():
    (maneuver,) = flown(maneuvers=1)
    t = maneuver.channels["q"].t
    # The estimate drifts with the manoeuvre's own motion.
    along = Channel("wind_along", t, np.where(t > maneuver.span.start_s, 9.0, -8.0))
    across = at(maneuver, wind_right=5.0)
    maneuver = replace(across, channels={**across.channels, "wind_along": along})
    flights, blown = prepare([maneuver], Aircraft()), winds([maneuver])
    began = Flying(Witness(), flights, {1: 0.0}, {1: {}}, None, lambda *_: None, blown)
    began.replays(np.zeros((1, 200)), held=False)
    assert Witness.conditions[-1].wind_m_s == pytest.approx((-8.0, 5.0), abs=0.5)


class Blown(Level):
    """Tells the wind that it was given as its angle of attack and its pitch angle."""

    takes = frozenset({"wind"})

    def replay(self, condition, inputs, increments=None):
        along, right = condition.wind_m_s
        flown = super().replay(condition, inputs, increments)
        return replace(flown, alpha=flown.alpha + along, theta=flown.theta + right)


def test_without_an_estimate_the_air_is_still_and_that_is_said_where_a_wind_is_taken():
    assert winds(flown(maneuvers=1)) == {}
    assert still_air_said(Blown(), {}) == ("The log has no estimate of the wind: level flies in still air.",)
    assert still_air_said(Blown(), {1: (0.0, 0.0)}) == still_air_said(Level(), {}) == ()


def test_the_wind_passes_to_a_python_simulator_in_its_own_process():
    apart = Isolated("tests.simulators.test_wind:Blown", description="Blown")
    try:
        assert apart.takes == {"wind"}
        told = apart.replay(BLOWN, STEP)
        assert (told.alpha[0], told.theta[0]) == (-8.0, 5.0)
    finally:
        apart.close()


def test_an_environment_resets_with_the_mass_and_wind_that_it_takes():
    from tests.simulators.test_stepped import LEVEL, Glides

    class Outside(Glides):
        def reset(self, speed, height, alpha, theta, mass, wind):
            super().reset(speed, height, alpha, theta)
            self.given = mass, wind

    outside = Outside()
    taking = Stepped(outside, "Outside", conditions=("mass", "wind"))
    taking.replay(replace(LEVEL, mass_kg=7.0, wind_m_s=(-8.0, 5.0)), STEP)
    assert outside.given == (7.0, (-8.0, 5.0))
    assert taking.takes == {"mass", "wind"}


def test_an_fmu_begins_with_the_wind_that_its_mapping_names(tmp_path: Path):
    pytest.importorskip("fmpy")
    from tests.simulators.test_fmu import NAMES, simulator

    named = replace(NAMES, trim=FmuTrim(airspeed="V", wind_along="alpha_0", wind_right="theta_0"))
    fmu = simulator(tmp_path, 2, named)
    told = fmu.replay(BLOWN, STEP)
    assert fmu.takes == {"wind"}
    assert (told.alpha[0], told.theta[0]) == (-8.0, 5.0)


def test_jsbsim_drifts_with_the_wind_and_flies_in_the_air_as_in_still_air(tmp_path: Path):
    pytest.importorskip("jsbsim")
    from advisor.simulators.jsbsim import Jsbsim
    from advisor.simulators.jsbsim_model import find_model

    # JSBSim's rate of α comes from the velocity over the ground, which a wind changes. It plays no part here.
    path = tmp_path / "c172p.xml"
    path.write_text(find_model("c172p").read_text().replace("aero/alphadot-rad_sec", "velocities/p-rad_sec"))
    simulator = Jsbsim(path)
    still, blown = (simulator.replay(condition, STEP) for condition in (STILL, BLOWN))
    fdm = simulator._flight.fdm
    north, east = (0.3048 * fdm[f"velocities/v-{axis}-fps"] for axis in ("north", "east"))
    assert (north, east) == pytest.approx((42.0, 5.0), abs=0.4)
    for name in ("alpha", "q", "a_z", "airspeed_m_s"):
        one, other = getattr(still, name), getattr(blown, name)
        assert other == pytest.approx(one, abs=0.005 * np.ptp(one)), name
    for name, value in simulator.linearise(BLOWN).items():
        assert value == pytest.approx(simulator.linearise(STILL)[name], rel=0.01, abs=0.01), name
