"""The advisor answers sixty unkind flights, and the endurance run notices what is no answer."""

import json
from functools import cache

import numpy as np
import pytest

from benchmarks.endure import trial
from benchmarks.endure.cases import Case, Unkindness, parsed
from benchmarks.endure.forms import FORMS
from benchmarks.endure.packets import Flight, changed, name, read, seconds, value, written
from benchmarks.endure.shrink import shrunk
from benchmarks.endure.trial import Failure, TooLong, failure, judged, limited
from tests.flights import TWO, recorded

PITCH, ELEVATOR = "ATTITUDE.pitch", "SERVO_OUTPUT_RAW.servo2_raw"
CASES = 60
SEED = 20261127
CHEAP = sorted(set(FORMS) - {"idle", "faster"})
"""Forms that make no log longer or denser."""


@cache
def log() -> bytes:
    return recorded("linear", 1.0, maneuvers=TWO).read_bytes()


@cache
def flight() -> Flight:
    return read(log())


def samples(of: Flight, channel: str) -> list[float]:
    message, field = channel.split(".")
    return [value(packet, field) for packet in of if name(packet.number) == message]


def applied(form: str, *words: object) -> Flight:
    return FORMS[form].apply(flight(), *words)


def drawn(number: int) -> Case:
    """A few seconds of the flight, with one form."""
    rng = np.random.default_rng([SEED, number])
    form = CHEAP[number % len(CHEAP)]
    begin, long = float(rng.random()) * 0.85, 0.02 + 0.13 * float(rng.random())
    piece = Unkindness("cut", (round(begin, 3), round(begin + long, 3)))
    words = tuple(FORMS[form].draw(flight(), rng))
    command = "doctor" if number % 3 == 0 else "live" if number % 3 == 1 else "analyze"
    return Case(command, str(recorded("linear", 1.0, maneuvers=TWO)), False, (piece, Unkindness(form, words)))


@pytest.mark.parametrize("number", range(CASES))
def test_an_unkind_flight_is_answered(number: int):
    case = drawn(number)
    assert failure(case) is None, case.repeat


def test_a_log_read_and_written_is_the_same_flight():
    assert read(written(flight())) == flight()
    assert len(flight()) > 1000


def test_a_clock_that_runs_half_as_fast_doubles_the_rate_of_stamps_and_of_the_vehicle():
    twice = applied("faster", 2.0)
    assert seconds(twice) == pytest.approx(seconds(flight()) / 2.0, rel=1e-6)
    before, after = (samples(of, "ATTITUDE.time_boot_ms") for of in (flight(), twice))
    assert after[-1] - after[0] == pytest.approx((before[-1] - before[0]) / 2.0, abs=2.0)


def test_thinning_to_a_rate_leaves_at_most_that_rate():
    thinned = samples(applied("rate", "all", 10.0), PITCH)
    assert len(thinned) / seconds(flight()) == pytest.approx(10.0, rel=0.05)


@pytest.mark.parametrize(
    ("form", "expected"),
    [("zero", 0.0), ("nan", np.nan), ("million", 1e6), ("millionth", 1e-6), ("negative", -1.0)],
)
def test_a_channel_is_changed_in_every_sample(form: str, expected: float):
    before, after = samples(flight(), PITCH), samples(applied(form, PITCH), PITCH)
    np.testing.assert_allclose(after, np.array(before) * expected, rtol=1e-5)


def test_an_integer_that_cannot_hold_a_number_is_clipped_and_says_unknown_for_nan():
    servo = next(packet for packet in flight() if name(packet.number) == "SERVO_OUTPUT_RAW")
    changes = {"million": lambda x: 1e6 * x, "negative": lambda x: -x, "nan": lambda x: np.nan}
    found = {
        kind: value(changed(servo, "servo2_raw", change), "servo2_raw") for kind, change in changes.items()
    }
    assert found == {"million": 65535.0, "negative": 0.0, "nan": 65535.0}


def test_a_record_ends_with_the_very_sample_in_which_the_elevator_moves():
    pulses = samples(applied("ends", ELEVATOR, 0.0), ELEVATOR)
    assert abs(pulses[-1] - pulses[-3]) > 10.0
    assert np.ptp(pulses[:-2]) < 10.0


def test_one_step_of_the_elevator_is_all_that_is_left():
    pulses = samples(applied("step", ELEVATOR, 0.5), ELEVATOR)
    half = len(pulses) * 9 // 10
    assert np.ptp(pulses[half:]) == 0.0


def test_an_hour_of_nothing_is_an_hour_on_both_clocks():
    late = applied("pause", 0.5, 3600.0)
    assert seconds(late) == pytest.approx(seconds(flight()) + 3600.0, abs=1e-3)
    assert max(np.diff(samples(late, "ATTITUDE.time_boot_ms"))) == pytest.approx(3_600_000.0, abs=100.0)


def test_the_text_of_a_case_gives_the_case_again():
    case = parsed("gap logs/a.tlog unnamed: cut 0.25 0.5; stop SERVO_OUTPUT_RAW.servo2_raw 0.5 1900")
    assert case.unkindnesses[1].words == (ELEVATOR, 0.5, 1900.0)
    assert parsed(str(case)) == case


def test_a_failure_is_shrunk_to_the_form_and_the_piece_that_it_needs():
    case = parsed("doctor logs/a.tlog: slow 0.3; nan ATTITUDE.pitch; zero ATTITUDE.roll")

    def fails(one: Case) -> bool:
        forms = [unkind.form for unkind in one.unkindnesses]
        pieces = [unkind.words for unkind in one.unkindnesses if unkind.form == "cut"]
        return "nan" in forms and all(float(begin) <= 0.6 <= float(end) for begin, end in pieces)

    small = shrunk(case, fails)
    assert [unkind.form for unkind in small.unkindnesses] == ["cut", "nan"]
    begin, end = map(float, small.unkindnesses[0].words)
    assert end - begin == pytest.approx(1 / 64, abs=1e-5)
    assert begin <= 0.6 <= end


INTERNAL = {"code": "internal", "part": "lateral, manoeuvre 3", "text": "A fault.", "fix": "Report it."}


@pytest.mark.parametrize(
    ("code", "out", "kind"),
    [
        (70, "", "exit 70"),
        (2, "{}", "exit 2"),
        (0, '{"value": NaN}', "document: NaN in the document"),
        (0, '{"value": -Infinity}', "document: -Infinity in the document"),
        (0, json.dumps({"problems": [INTERNAL]}), "internal: lateral, manoeuvre N at ?"),
        (0, json.dumps({"maneuvers": [{"reasons": [INTERNAL]}]}), "internal: lateral, manoeuvre N at ?"),
    ],
)
def test_what_is_no_answer_is_a_failure_of_its_kind(code: int, out: str, kind: str):
    found = judged(code, out, "")
    assert isinstance(found, Failure)
    assert found.kind == kind


def test_a_verdict_with_contradicting_advice_is_a_failure():
    reasons = [{"text": "too large; use less stick"}, {"text": "too small; use 1.4 times the stick"}]
    document = {"maneuvers": [{"verdict": "rejected", "reasons": reasons}]}
    found = judged(0, json.dumps(document), "")
    assert found is not None
    assert found.kind.startswith("advice")


@pytest.mark.parametrize("code", [0, 3])
def test_a_document_with_a_problem_of_the_log_is_an_answer(code: int):
    assert judged(code, '{"problems": [{"code": "rate", "text": "Too slow.", "fix": "Faster."}]}', "") is None


@pytest.mark.parametrize("command", ["doctor", "analyze", "live"])
def test_an_error_that_leaves_the_advisor_is_a_failure_with_its_kind(command, monkeypatch):
    def divide(*_: object, **__: object) -> float:
        raise ZeroDivisionError

    monkeypatch.setattr(trial.cli, "main", divide)
    monkeypatch.setattr(trial, "LogSeries", divide)
    found = failure(Case(command, str(recorded("linear", 1.0, maneuvers=TWO))))
    assert found is not None
    assert found.kind.startswith("exit 70: ZeroDivisionError")


def for_ever():
    while True:
        pass


def test_an_answer_that_takes_longer_than_its_limit_is_ended():
    with pytest.raises(TooLong), limited(0.05):
        for_ever()
