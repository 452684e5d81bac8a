"""The lateral half of a flight from messages to its document."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, SideControl
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import HandDecision
from advisor.flight.maneuvers.markers import SWEPT
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.vehicle.parameters import filter_delay_s
from advisor.report.document import lateral_document
from advisor.report.facts.answers import lateral_decision
from advisor.report.text import joint_table, maneuver_line
from tests.flight.columns import Wire, heartbeat, plane_parameters
from tests.heard import hear
from tests.oem.axis.builders import JET, flown, steps

RATE_HZ = 25.0
T = np.arange(0.0, 40.0, 1.0 / RATE_HZ)
KNOWN = SideControl(lag_s=0.0, delay_s=0.0)
AIRCRAFT = Aircraft(aileron=KNOWN, rudder=KNOWN)


def wired(*, rudder=True, mode=0):
    """Return the messages of a jet that flies an aileron doublet and, on request, a rudder doublet."""
    aileron = steps(T, (3.0, 4.0, 5.0), (0.06, -0.06, 0.0))
    feet = steps(T, (20.0, 21.6, 23.2), (0.05, -0.05, 0.0))
    record = flown(
        JET, aileron=aileron, rudder=feet if rudder else None, seconds=40.0, rate_hz=RATE_HZ,
        rng=np.random.default_rng(4), measured=("p", "r", "bank", "a_y"), initial=(0.0, 0.0, 0.0, 0.0),
    )  # fmt: skip
    late_s = filter_delay_s("p", "ATTITUDE.rollspeed", "ardupilot", {})

    def read(name, late=0.0):
        signal = record.outputs[name]
        return np.interp(T - late, signal.t, signal.y)

    p, r, bank = read("p", late_s), read("r", late_s), read("bank")
    force = read("a_y", late_s) / GRAVITY_M_S2 * 1000.0
    wire = Wire()
    heartbeat(wire, 0.0, mode)
    plane_parameters(wire, 1e-3)
    for k, since in enumerate(T):
        now, boot = 0.01 + since, 100.0 + since
        if k % 25 == 0:
            heartbeat(wire, now, mode)
        wire.send(
            "ATTITUDE", now, time_boot_ms=round(boot * 1000), roll=bank[k], pitch=0.105, yaw=0.0,
            rollspeed=p[k], pitchspeed=0.01 + 1e-4 * (k % 2), yawspeed=r[k],
        )  # fmt: skip
        wire.send(
            "RAW_IMU", now + 1e-4, time_usec=round(boot * 1e6), xacc=0.0, yacc=force[k],
            zacc=-1000.0 + 0.1 * (k % 2),
        )  # fmt: skip
        wire.send("AOA_SSA", now + 2e-4, time_usec=round(boot * 1e6), AOA=4.0 + 0.01 * (k % 2), SSA=0.0)
        pulses = dict.fromkeys(range(1, 17), 0) | {3: 1600, 2: 1500}
        for output, command in ((1, aileron), (4, feet)):
            moved = command.y[k] if output == 1 or rudder else 0.0
            pulses[output] = round(1500.0 - 400.0 * np.degrees(moved) / 25.0, 2)
        wire.send(
            "SERVO_OUTPUT_RAW", now + 3e-4, time_usec=round(boot * 1e6), port=0,
            **{f"servo{n}_raw": pulse for n, pulse in pulses.items()},
        )  # fmt: skip
        wire.send(
            "VFR_HUD", now + 4e-4, airspeed=130.0 + 0.01 * (k % 2), groundspeed=131.0, throttle=50, alt=100.0,
            climb=0.0,
        )  # fmt: skip
    return wire


def ended(wire, batches=1):
    campaign = Campaign(AIRCRAFT, lateral=True)
    for rows in np.array_split(np.arange(len(wire)), batches):
        campaign.feed(wire.columns(rows.tolist()))
    campaign.finish()
    return campaign.state.lateral


@pytest.fixture(scope="module")
def both():
    return wired()


@pytest.fixture(scope="module")
def state(both):
    return ended(both)


def test_both_doublets_are_found_named_and_accepted(state):
    assert [one.maneuver.span.kind for one in state.maneuvers] == ["aileron doublet", "rudder doublet"]
    assert [one.verdict.accepted for one in state.maneuvers] == [True, True]


def test_the_joint_estimate_has_the_truth_in_its_intervals(state):
    estimate = state.model
    for name in ("L_p", "L_delta_a", "N_beta", "N_delta_r", "L_beta"):
        off = estimate.value(name) - JET[name]
        assert abs(off) < 3.0 * estimate.std[estimate.names.index(name)], name
        assert abs(off) < 0.06 * abs(JET[name]), name


def test_a_derivative_is_told_or_not_identifiable_and_never_both(state):
    document = lateral_document(state, AIRCRAFT)
    told = set(document["model"]) - {"reference_airspeed_m_s", "instruments"}
    assert told.isdisjoint(document["not_identifiable"])
    assert told | set(document["not_identifiable"]) == set(state.model.names)
    assert document["modes"]["dutch_roll"]["omega"]["value"] == pytest.approx(1.81, rel=0.03)


def test_the_text_says_every_verdict_and_the_decision(state):
    lines = [maneuver_line(one, 18) for one in state.maneuvers]
    assert sum("doublet" in line and "✓" in line for line in lines) == 2
    table = joint_table(state, AIRCRAFT.model)
    assert [row[0] for row in table.rows if row[1] != "–"][:2] == ["Y_β", "Y_p"]
    assert table.caption.startswith("Joint estimate from manoeuvres 1, 2 at ")
    assert next(lateral_decision(state)).startswith("Roll and yaw: CONTINUE: ")


def test_the_result_does_not_depend_on_the_batches(both, state):
    live = ended(both, batches=60)
    assert [one.maneuver.span for one in live.maneuvers] == [one.maneuver.span for one in state.maneuvers]
    np.testing.assert_array_equal(live.model.theta, state.model.theta)


def test_without_a_rudder_input_the_advice_is_a_rudder_doublet():
    state = ended(wired(rudder=False))
    assert lateral_document(state, AIRCRAFT)["not_identifiable"]["N_delta_r"].endswith("fly a rudder doublet")
    assert state.flight_test.next.advice.startswith("next: rudder doublet")


def test_a_campaign_that_is_not_asked_has_no_lateral_half(both):
    campaign = Campaign(AIRCRAFT)
    campaign.feed(both.columns(list(range(200))))
    assert campaign.state.lateral is None


def test_every_interval_is_that_of_95_percent(state):
    document = lateral_document(state, AIRCRAFT)
    told = [
        one for name, one in document["model"].items() if "ci95" in (one if isinstance(one, dict) else {})
    ]
    assert len(told) > 10
    for one in told:
        assert one["ci95"] == pytest.approx(
            [one["value"] - 1.96 * one["std"], one["value"] + 1.96 * one["std"]], rel=1e-4
        )


def marked(wire, *marks):
    campaign = Campaign(AIRCRAFT, marks=marks, lateral=True)
    campaign.feed(wire.columns(list(range(len(wire)))))
    campaign.finish()
    return campaign.state


def test_a_mark_of_an_aileron_input_replaces_the_one_that_was_found(both, state):
    told = marked(both, Mark(102.5, 112.0))
    spans = [one.maneuver.span for one in told.lateral.maneuvers]
    assert [span.kind for span in spans] == ["aileron doublet", "rudder doublet"]
    assert spans[0].end_s == 112.0
    assert spans[0].closed_by == "marked by hand"
    assert spans[1] == state.maneuvers[1].maneuver.span


def test_a_mark_without_elevator_is_no_manoeuvre_of_the_elevator(both):
    assert marked(both, Mark(102.5, 112.0)).maneuvers == ()


def kinds_swept(wire):
    """Return the kinds of lateral manoeuvres in a stretch that SystemID has marked."""
    marks = [Mark(102.5, 112.0, by="system id")]
    heard = hear([wire.columns()], AIRCRAFT, marks=marks, lateral=True)
    return [maneuver.span.kind for maneuver in heard.sideways if maneuver.span.closed_by == SWEPT]


def test_a_sweep_of_system_id_by_the_ailerons_is_a_lateral_manoeuvre(both):
    assert kinds_swept(both) == ["aileron doublet"]


def test_a_sweep_of_system_id_in_hover_is_no_lateral_manoeuvre():
    assert kinds_swept(wired(mode=18)) == []


def test_an_uncalibrated_aileron_is_per_assumed_degree(both):
    notes = marked(both).elevator_notes
    said = [note for note in notes if note.startswith("No aileron.calibration")]
    assert len(said) == 1
    assert "Y_δa, L_δa and N_δa are per assumed degree." in said[0]
    assert any(note.startswith("No rudder.calibration") for note in notes)


def without_parameters(wire, aircraft):
    """Return the state after a flight none of whose parameters was recorded."""
    campaign = Campaign(aircraft, lateral=True)
    campaign.feed([c for c in wire.columns() if c.name != "PARAM_VALUE"])
    campaign.finish()
    return campaign.state.lateral


@pytest.mark.parametrize(
    ("aircraft", "said"),
    [
        (AIRCRAFT, "The outputs of aileron and rudder are not known. For roll and yaw, give aileron.output"),
        (
            Aircraft(aileron=SideControl(output=5), rudder=KNOWN),
            "The output of rudder is not known. For roll and yaw, give rudder.output in the aircraft file",
        ),
    ],
)
def test_where_nothing_states_an_output_that_is_said_and_not_that_nothing_was_flown(both, aircraft, said):
    state = without_parameters(both, aircraft)
    assert state.maneuvers == ()
    assert state.flight_test.next is None
    assert joint_table(state, {}) is None
    (line,) = lateral_decision(state)
    assert line.startswith(f"Roll and yaw: {said}")


@pytest.fixture(scope="module")
def by_the_file(both):
    """Return the lateral state of a log without parameters, by outputs of the aircraft file."""
    told = Aircraft(aileron=SideControl(output=1, lag_s=0.0, delay_s=0.0), rudder=SideControl(output=4))
    return without_parameters(both, told)


def test_outputs_of_the_file_need_no_parameters(by_the_file):
    assert len(by_the_file.maneuvers) == 2


def test_a_decision_by_hand_on_roll_and_yaw_leaves_pitch_alone(both):
    campaign = Campaign(AIRCRAFT, lateral=True)
    campaign.feed(both.columns(list(range(len(both)))))
    campaign.finish()
    decision = HandDecision("exclude", "gust", 2, "lateral")
    assert decision.due(campaign.state)
    campaign.engineer.apply(decision)
    campaign.engineer.apply(HandDecision("note", "rough air", 1, "lateral"))
    first, second = lateral_document(campaign.state.lateral, AIRCRAFT)["maneuvers"]
    assert (first["excluded_because"], first["notes"]) == (None, ["rough air"])
    assert (second["excluded_because"], second["verdict"]) == ("gust", "rejected")
    assert campaign.state.lateral.estimate_from == (1,)
    assert not HandDecision("exclude", "gust", 2).due(campaign.state)
    assert "roll and yaw, manoeuvre 2 excluded: gust" in " ".join(campaign.state.notices)
