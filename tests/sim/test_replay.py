"""Aircraft files flown by the simulator, and recorded inputs flown again."""

import io
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import yaml

from advisor.gap.effects import EFFECTS
from sim.compare import distances
from sim.effects.fitting import flight_of
from sim.linear import RESEARCH_JET
from sim.linear_aircraft import LinearAircraft
from sim.linear_motion import rates
from sim.loading import ScenarioError
from sim.modelled import modelled_flight
from sim.record import record
from sim.scenario import Maneuver, Noise, Scenario, read_scenario
from sim.tlog import read_tlog

LATE = Path(str(files("sim") / "scenarios" / "late-command.yaml"))
QUIET = Scenario(maneuvers=(Maneuver("3211"), Maneuver("rev")), noise=Noise())
BRIEF = replace(QUIET, lead_in_s=2.0, gap_s=2.0, free_s=2.0, closing_s=1.0)
"""Two manoeuvres in half the time."""


def aircraft_file(path, **more):
    path.write_text(yaml.safe_dump({"model": RESEARCH_JET.as_dict(), "airspeed_m_s": 100.0, **more}))
    return path


def streams(path):
    found = {"ATTITUDE": [], "AOA_SSA": [], "SERVO_OUTPUT_RAW": [], "HEARTBEAT": []}
    for _, message in read_tlog(path, found):
        found[message.get_type()].append(message)
    stamps = [message.time_boot_ms for message in found["ATTITUDE"]]
    return {
        "time": np.array(stamps) / 1e3,
        "q": np.array([message.pitchspeed for message in found["ATTITUDE"]]),
        "alpha": np.radians([message.AOA for message in found["AOA_SSA"]]),
        "pulse": np.array([message.servo2_raw for message in found["SERVO_OUTPUT_RAW"]]),
    }


def test_flying_a_log_again_through_the_same_aircraft_gives_the_same_manoeuvres(tmp_path):
    path = aircraft_file(tmp_path / "jet.yaml", effects={"transport_delay": {"delay_s": 0.06}})
    record(modelled_flight(BRIEF, path), tmp_path / "first.tlog")
    record(modelled_flight(BRIEF, path, tmp_path / "first.tlog"), tmp_path / "again.tlog")
    first, again = streams(tmp_path / "first.tlog"), streams(tmp_path / "again.tlog")
    assert first["time"][0] == again["time"][0]
    for planned in modelled_flight(BRIEF, path).planned:
        flown = slice(round(50 * planned.start_s), round(50 * planned.end_s) - 50)
        for name in ("q", "alpha"):
            np.testing.assert_allclose(
                again[name][flown], first[name][flown], atol=0.03 * np.ptp(first[name])
            )


def test_several_elevator_outputs_are_refused_with_what_to_give(tmp_path):
    path = aircraft_file(tmp_path / "elevons.yaml", elevator={"outputs": [{"output": 1}, {"output": 2}]})
    with pytest.raises(ScenarioError, match="has one elevator output"):
        modelled_flight(QUIET, path)


def test_an_effect_in_the_aircraft_file_changes_the_flight(tmp_path):
    plain = aircraft_file(tmp_path / "plain.yaml")
    late = aircraft_file(tmp_path / "late.yaml", effects={"transport_delay": {"delay_s": 0.1}})
    record(modelled_flight(QUIET, plain), tmp_path / "plain.tlog")
    record(modelled_flight(QUIET, late, tmp_path / "plain.tlog"), tmp_path / "late.tlog")
    there, here = streams(tmp_path / "plain.tlog"), streams(tmp_path / "late.tlog")
    flown = slice(480, 900)
    by_shift = {
        shift: np.abs(here["q"][480 + shift : 900 + shift] - there["q"][flown]).mean() for shift in range(10)
    }
    assert min(by_shift, key=by_shift.get) == 5


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """Readings of the aircraft without any effect."""
    path = aircraft_file(tmp_path_factory.mktemp("plain") / "plain.yaml")
    return [s.reading for s in modelled_flight(BRIEF, path).samples()]


@pytest.mark.parametrize(
    ("effect", "sizes"),
    [
        ("nonlinear_lift", {"Z_alpha2": 3.0, "Z_alpha3": 1.0}),
        ("nonlinear_lift", {"stall_rad": 0.1, "sharpness": 40.0}),
        ("nonlinear_pitching_moment", {"M_alpha2": 20.0, "M_alpha3": 1.0}),
        ("elevator_nonlinearity", {"M_delta2": 30.0, "M_delta3": 10.0}),
        ("alpha_dot", {"M_alpha_dot": -1.0}),
        ("unsteady_lift", {"share": 0.3, "lag_s": 0.3}),
        ("unsteady_lift", {"share": 0.3, "lag_s": 0.3, "with_moment": 1.0}),
        ("cg_shift", {"step": 0.2, "at_s": 35.0}),
        ("cg_shift", {"step": 0.2, "at_s": 20.0, "over_s": 30.0}),
        ("cg_shift", {"step": 0.2, "at_s": 35.0, "stability_only": 1.0}),
        ("mass_change", {"rate_per_s": 0.01}),
        ("mass_change", {"step": 0.3, "inertia": 0.1, "at_s": 35.0}),
        ("icing", {"Z_alpha": -0.2, "M_alpha": -0.2, "at_s": 35.0}),
        ("ground_effect", {"Z_h": -0.05, "M_h": 0.05, "scale_m": 100.0}),
        ("ground_effect", {"lift_h": 0.2, "scale_m": 100.0}),
        ("thrust_moment", {"M_throttle": 1.0}),
        ("thrust_moment", {"M_throttle": 1.0, "lag_s": 0.5}),
        ("structural_mode", {"gain": 2.0, "frequency_hz": 3.0, "damping": 0.05}),
        ("alpha_skew", {"skew_s": -0.05}),
        ("turbulence", {"sigma_w_m_s": 1.0, "length_m": 100.0}),
        ("turbulence", {"sigma_w_m_s": 1.0}),
        ("gust", {"amplitude_m_s": 2.0, "at_s": 35.0}),
    ],
)
def test_every_kind_of_added_term_can_be_flown(plain, tmp_path, effect, sizes):
    path = aircraft_file(tmp_path / "b.yaml", effects={effect: sizes})
    changed = [s.reading for s in modelled_flight(BRIEF, path).samples()]
    moved = max(abs(a.q - b.q) + abs(a.alpha - b.alpha) for a, b in zip(plain, changed, strict=True))
    assert (moved > 1e-4) == (effect != "thrust_moment")


KEYS = {name: effect.keys for name, effect in EFFECTS.items()}
NO_SIZE = {effect: dict.fromkeys(sizes, 0.0) for effect, sizes in KEYS.items()}
NO_SIZE["actuator_rate_limit"]["rate_rad_s"] = 1e9


# A file that names the air speed has it known to the simulator, whatever its power.
SIZELESS = [effect for effect in KEYS if effect != "airspeed_variation"]


def test_effects_of_no_size_are_no_effects(plain, tmp_path):
    def change(names):
        """Largest change of the readings by effects of no size, in one flight."""
        path = aircraft_file(tmp_path / "none.yaml", effects={name: NO_SIZE[name] for name in names})
        same = [s.reading for s in modelled_flight(BRIEF, path).samples()]
        return max(max(abs(a.alpha - b.alpha), abs(a.q - b.q)) for a, b in zip(plain, same, strict=True))

    # Only where all together change something does each fly alone, to be named.
    assert change(SIZELESS) < 1e-9, [name for name in SIZELESS if change([name]) >= 1e-9]


def test_a_channel_that_is_ahead_shows_what_its_lag_would_hide(plain, tmp_path):
    ahead = aircraft_file(tmp_path / "ahead.yaml", effects={"alpha_lag": {"lag_s": -0.02}})
    shown = np.array([s.reading.alpha for s in modelled_flight(BRIEF, ahead).samples()])
    true = np.array([r.alpha for r in plain])
    # 20 ms ahead is one sample; the rest is the curvature of the motion.
    assert np.abs(shown[:-1] - true[1:]).max() < 0.2 * np.abs(shown - true).max()


def test_a_gust_is_strongest_when_the_file_says(tmp_path):
    gust = {"amplitude_m_s": 2.0, "at_s": 35.0}
    flight = modelled_flight(QUIET, aircraft_file(tmp_path / "gust.yaml", effects={"gust": gust}))
    met = [(flight.scenario.clock.boot_s + s.time_s, s.motion.gust_up) for s in flight.samples()]
    at_s, strongest = max(met, key=lambda pair: pair[1])
    assert at_s == pytest.approx(35.0, abs=0.03)
    assert strongest == pytest.approx(2.0, rel=0.02)


def test_a_drift_counts_from_the_first_manoeuvre_in_a_replay_too(tmp_path):
    drift = {"mass_change": {"rate_per_s": 0.002}}
    path = aircraft_file(tmp_path / "drift.yaml", effects=drift)
    record(modelled_flight(QUIET, path), tmp_path / "first.tlog")

    def at_the_end(flight):
        for _ in flight.samples():
            pass
        return float(flight.engine.record["Z_alpha"][0])

    planned = at_the_end(modelled_flight(QUIET, path))
    replayed = at_the_end(modelled_flight(QUIET, path, tmp_path / "first.tlog"))
    assert replayed == pytest.approx(planned, rel=0.004)
    assert planned == pytest.approx(at_the_end(modelled_flight(QUIET, aircraft_file(path))) / 1.07, rel=0.02)


def test_a_curve_about_another_angle_leaves_the_trim_and_is_that_curve(tmp_path):
    alpha, elevator = RESEARCH_JET.trim()
    model = RESEARCH_JET
    curved = LinearAircraft(model, 100.0, 100.0)
    curved.record["M_alpha2"], curved.record["M_about"] = 20.0, alpha - 0.05
    at_trim, moved = np.empty(8), np.empty(8)
    state = np.array([alpha, 0.0, alpha, 100.0, 0.0, 0.0, alpha, 0.5])
    inputs = np.array([elevator, 0.5, 0.0, 0.0, 100.0, 0.0, 0.0, 0.0])
    rates(state, inputs, curved.record, at_trim)
    up = np.array([0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.0])
    rates(state + up, inputs, curved.record, moved)
    assert at_trim[1] == pytest.approx(0.0, abs=1e-12)
    assert moved[1] == pytest.approx(0.01 * model.M_alpha + 20.0 * (0.06**2 - 0.05**2))


def test_a_change_of_mass_or_of_the_centre_of_gravity_moves_all_but_the_weights_own_part(tmp_path):
    def flown(effects):
        flight = modelled_flight(BRIEF, aircraft_file(tmp_path / "changed.yaml", effects=effects))
        for _ in flight.samples():
            pass
        return {name: float(flight.engine.record[name][0]) for name in flight.engine.record.dtype.names}

    plain = flown({})
    weight = 9.80665 / plain["speed_ref"]
    heavier = flown({"mass_change": {"step": 0.25, "at_s": 0.0}})
    assert heavier["Z_0"] - weight == pytest.approx((plain["Z_0"] - weight) / 1.25)
    assert [heavier[n] * 1.25 for n in ("Z_alpha", "M_0", "M_q")] == pytest.approx(
        [plain[n] for n in ("Z_alpha", "M_0", "M_q")]
    )
    held_close = flown({"mass_change": {"step": 0.25, "inertia": 0.1, "at_s": 0.0}})
    assert held_close["Z_alpha"] == heavier["Z_alpha"]
    assert held_close["M_q"] == pytest.approx(plain["M_q"] / 1.1)
    aft = flown({"cg_shift": {"step": -0.3, "at_s": 0.0}})
    arm = -0.3 * plain["M_alpha"] / plain["Z_alpha"]
    assert aft["M_alpha"] == pytest.approx(0.7 * plain["M_alpha"])
    assert aft["M_0"] - plain["M_0"] == pytest.approx(arm * (plain["Z_0"] - weight))
    assert aft["M_delta_e"] - plain["M_delta_e"] == pytest.approx(arm * plain["Z_delta_e"])


def test_an_aircraft_file_that_cannot_be_flown_says_everything_that_is_wrong(tmp_path):
    path = tmp_path / "bad.yaml"
    path.write_text(
        yaml.safe_dump({"model": {"Z_0": 1.0}, "effects": {"wobble": {}, "alpha_lag": {"lag": 1}}})
    )
    with pytest.raises(ScenarioError) as caught:
        modelled_flight(QUIET, path)
    text = "\n".join(caught.value.problems)
    assert "model: Z_alpha" in text
    assert "effects.wobble: unknown effect" in text
    assert "effects.alpha_lag.lag: unknown parameter, choose from lag_s" in text


def test_a_log_without_elevator_is_refused(tmp_path):
    (tmp_path / "empty.tlog").write_bytes(b"")
    with pytest.raises(ScenarioError, match="no SERVO_OUTPUT_RAW"):
        modelled_flight(QUIET, aircraft_file(tmp_path / "a.yaml"), tmp_path / "empty.tlog")


def test_damage_between_records_is_skipped(tmp_path):
    path = tmp_path / "log.tlog"
    record(modelled_flight(BRIEF, aircraft_file(tmp_path / "a.yaml")), path)
    data = path.read_bytes()
    whole = sum(1 for _ in read_tlog(path, ["ATTITUDE"]))
    damaged = io.BytesIO(data[:5000] + b"\x00" * 200 + data[5000:])
    path.write_bytes(damaged.getvalue())
    assert whole - sum(1 for _ in read_tlog(path, ["ATTITUDE"])) <= 2


def test_the_improved_simulator_is_nearer_to_the_flight_than_the_old_one(tmp_path):
    late = read_scenario(LATE)
    scenario = replace(BRIEF, aircraft=late.aircraft, effects=late.effects)
    flight = flight_of(scenario)
    record(flight, tmp_path / "flight.tlog")
    model = flight.engine.truth.as_dict()
    apart = {}
    for name, effects in (("old", {}), ("improved", dict(scenario.effects))):
        path = tmp_path / f"{name}.yaml"
        path.write_text(yaml.safe_dump({"model": model, "reference_airspeed_m_s": 25.0, "effects": effects}))
        record(modelled_flight(scenario, path, tmp_path / "flight.tlog"), tmp_path / f"{name}.tlog")
        apart[name] = distances(tmp_path / "flight.tlog", tmp_path / f"{name}.tlog")
    assert [d.channel for d in apart["old"]] == ["alpha", "q", "theta", "a_z"]
    for old, improved in zip(apart["old"], apart["improved"], strict=True):
        assert improved.difference < 0.15 * old.difference
        assert improved.difference < 0.05 * improved.signal


def test_a_flight_compared_with_itself_is_not_apart(tmp_path):
    record(modelled_flight(BRIEF, aircraft_file(tmp_path / "a.yaml")), tmp_path / "a.tlog")
    assert all(d.difference == 0.0 < d.signal for d in distances(tmp_path / "a.tlog", tmp_path / "a.tlog"))


def test_a_flight_without_manual_cannot_be_compared(tmp_path):
    scenario = replace(BRIEF, maneuvers=())
    record(modelled_flight(scenario, aircraft_file(tmp_path / "a.yaml")), tmp_path / "a.tlog")
    with pytest.raises(ScenarioError, match="nothing flown in MANUAL"):
        distances(tmp_path / "a.tlog", tmp_path / "a.tlog")
