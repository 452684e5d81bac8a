"""Contradictions of the instruments, asked by verdict, advice, doctor and screens."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator, SideControl
from advisor.campaign.campaign import Campaign
from advisor.campaign.single_maneuver import as_known_by, side_signs, together
from advisor.campaign.state import CampaignState
from advisor.doctor.examination import Examination
from advisor.doctor.examiner import Examiner
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.trust import InstrumentFinding
from advisor.mavlink.logs.logs import open_log
from advisor.oem.axis.estimate import AxisEstimate
from tests.campaign import side_builders
from tests.heard import hear

CASES = Path(__file__).parents[1] / "cases"
Fault = Callable[[Columns], Columns]


def changed(message: str, field: str, change: Callable[[np.ndarray], np.ndarray]) -> Fault:
    def fault(columns: Columns) -> Columns:
        if columns.name != message:
            return columns
        fields = {**columns.fields, field: change(np.asarray(columns.fields[field]))}
        return replace(columns, fields=fields)

    return fault


def both(log: str, fault: Fault, aircraft: Aircraft | None = None) -> tuple[CampaignState, Examination]:
    """Return what analyze and doctor tell of a log with one fault put in."""
    campaign, examiner = Campaign(aircraft or Aircraft()), Examiner(aircraft or Aircraft())
    for columns in open_log(CASES / log):
        faulty = [fault(c) for c in columns]
        campaign.feed(faulty)
        examiner.feed(faulty)
    campaign.finish()
    return campaign.state, examiner.findings()


@cache
def sound() -> CampaignState:
    """Return what analyze tells of the log without a fault."""
    state, _ = both("t_base.tlog", lambda columns: columns)
    return state


def told(found: Sequence[InstrumentFinding]) -> list[tuple[str, bool]]:
    return [(one.code, one.used) for one in found if one.contradicts]


@pytest.mark.parametrize(("factor", "code"), [(-1.0, "alpha_sign"), (np.pi / 180.0, "alpha_unit")])
def test_a_wrong_vane_refuses_the_manoeuvre_and_asks_nothing_of_the_pilot(factor: float, code: str) -> None:
    state, examined = both("t_base.tlog", changed("AOA_SSA", "AOA", lambda y: factor * y))
    (judged,) = state.maneuvers
    assert [reason.code for reason in judged.verdict.reasons] == [code]
    assert state.flight_test.decision == "continue"
    assert state.flight_test.next is not None
    assert "AOA_SSA.AOA" in state.flight_test.next.advice
    assert not {"stick", "again"} & set(state.flight_test.next.advice.split())
    assert told(state.instruments) == told(examined.instruments) == [(code, False)]
    assert examined.verdict == "not usable"
    assert code in {limit.code for limit in examined.limits}


def test_a_wrong_vane_is_named_before_anything_is_flown() -> None:
    reverse = changed("AOA_SSA", "AOA", lambda y: -y)
    examiner = Examiner(Aircraft())
    for columns in open_log(CASES / "t_base.tlog"):
        examiner.feed([reverse(c) for c in columns if c.name != "SERVO_OUTPUT_RAW"])
    assert told(examiner.findings().instruments) == [("alpha_sign", False)]


def test_a_correction_is_written_into_the_event_log() -> None:
    state, _ = both("t_base.tlog", changed("RAW_IMU", "zacc", lambda z: -z))
    assert told(state.instruments) == [("a_z_sign", True)]
    assert any("A_z is z up" in line for line in state.notices)


def test_a_force_in_counts_is_estimated_as_the_sound_log() -> None:
    def counts(columns: Columns) -> Columns:
        for field in ("xacc", "zacc"):
            columns = changed("RAW_IMU", field, lambda y: np.round(2.048 * y))(columns)
        return columns

    state, examined = both("t_base.tlog", counts)
    assert told(sound().instruments) == []
    assert told(state.instruments) == told(examined.instruments) == [("a_z_unit", True)]
    assert state.model is not None
    model = sound().model
    assert model is not None
    np.testing.assert_allclose(state.model.theta, model.theta, rtol=0.02, atol=0.02)


@pytest.mark.parametrize(
    ("messages", "codes"),
    [
        (("HIGHRES_IMU",), ["a_z_delay_s"]),
        (("HIGHRES_IMU", "ATTITUDE"), ["q_delay_s", "a_z_delay_s"]),
    ],
)
def test_clocks_that_differ_are_named_with_their_size(messages: tuple[str, ...], codes: list[str]) -> None:
    """A PX4 log has no angle of attack; its pitch rate is delayed by samples of 10 ms, for one message
    carries the attitude as well."""

    def late(columns: Columns) -> Columns:
        if columns.name not in messages:
            return columns
        if columns.name == "HIGHRES_IMU":
            return changed("HIGHRES_IMU", "time_usec", lambda t: t + 120_000)(columns)
        return changed("ATTITUDE", "pitchspeed", lambda q: np.concatenate((np.full(12, q[0]), q[:-12])))(
            columns
        )

    state, examined = both("u_base.ulg", late, Aircraft(elevator=Elevator(output=2)))
    assert [found.code for found in state.instruments] == codes
    assert told(state.instruments) == told(examined.instruments)
    assert all(found.value == pytest.approx(0.13, abs=0.02) for found in state.instruments)
    assert not any(judged.verdict.accepted for judged in state.maneuvers)


def maneuver(*findings: InstrumentFinding, boot: int = 0) -> Maneuver:
    span = Span(0.0, 1.0, 2.0, 3.0, "3-2-1-1", (), "quiet")
    return Maneuver(1, boot, span, {}, findings=findings)


REFUSED = InstrumentFinding("alpha", "sign", "nose up", "nose down", contradicts=True)
LATE = InstrumentFinding("a_z", "delay_s", None, 0.1, 0.01, contradicts=True, used=True)


def test_an_earlier_manoeuvre_is_refused_by_what_a_later_one_tells() -> None:
    (known,) = as_known_by(maneuver(), maneuver(REFUSED)).findings
    assert repr(known) == repr(REFUSED)  # NaN equals nothing
    assert as_known_by(maneuver(boot=1), maneuver(REFUSED)).findings == ()


def test_an_error_that_was_not_removed_from_an_earlier_record_refuses_it() -> None:
    (found,) = as_known_by(maneuver(), maneuver(LATE)).findings
    assert found.refuses
    removed = maneuver(LATE)
    assert as_known_by(removed, maneuver(LATE)) is removed


def test_each_contradiction_is_told_once_as_the_newest_manoeuvre_tells_it() -> None:
    newer = replace(REFUSED, text="newer")
    assert together([maneuver(REFUSED), maneuver(newer)], [REFUSED]) == (newer,)


def test_what_the_fit_tells_stands_among_the_instruments_without_contradicting() -> None:
    assert {"elevator_lag_s", "elevator_delay_s"} <= {one.code for one in sound().instruments}


def test_an_elevator_typed_with_the_other_sign_is_refused_on_its_manoeuvre() -> None:
    typed = Elevator(output=2, calibration=((1000.0, -25.0), (1500.0, 0.0), (2000.0, 25.0)))
    state, _ = both("t_base.tlog", lambda columns: columns, Aircraft(elevator=typed))
    (judged,) = state.maneuvers
    assert judged.verdict.reasons[0].code == "elevator_sign"
    assert told(state.instruments) == [("elevator_sign", False)]
    assert "turn the sign of every deflection" in state.flight_test.next.advice


def test_a_specific_force_that_stands_still_is_named_and_nothing_is_computed_from_it() -> None:
    still = changed("RAW_IMU", "zacc", np.zeros_like)
    (maneuver,) = hear(list(map(still, columns)) for columns in open_log(CASES / "t_base.tlog")).maneuvers
    assert "a_z" not in maneuver.channels
    assert maneuver.channels["alpha"].provenance == "unknown"
    assert told(together([maneuver], ())) == [("a_z_rate", True)]


def lateral(aileron: float) -> AxisEstimate:
    """A joint estimate of the jet whose aileron rolls with this moment, known to 2 %."""
    found = side_builders.estimate("aileron", "rudder")
    k = found.names.index("L_delta_a")
    theta = found.theta.copy()
    theta[k] = aileron
    return replace(found, theta=theta)


def test_without_a_calibration_the_sign_of_the_aileron_is_said_to_be_taken() -> None:
    told = {f.code: f for f in side_signs(lateral(-6.0), Aircraft())}
    assert set(told) == {"aileron_sign", "rudder_sign"}
    assert told["aileron_sign"].quantity == "sign"
    assert told["aileron_sign"].stated is None
    assert told["aileron_sign"].value == "left"
    assert not told["aileron_sign"].contradicts
    assert told["aileron_sign"].text.startswith("no aileron.calibration states the sign of the aileron")


def test_an_aileron_that_rolls_to_the_right_is_named_and_refuses_nothing() -> None:
    aircraft = Aircraft(aileron=SideControl(calibration=((1000.0, -25.0), (2000.0, 25.0))))
    (found,) = (f for f in side_signs(lateral(6.0), aircraft) if f.channel == "aileron")
    assert (found.stated, found.value, found.contradicts, found.refuses) == ("left", "right", True, False)
    assert found.fix == "give aileron.calibration with positive to the left"


def test_without_a_lateral_estimate_no_sign_is_told() -> None:
    assert side_signs(None, Aircraft()) == ()
