"""``advisor gap --prove``: the improved simulator flies manoeuvres that no fit has used."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap import GapFlights
from advisor.exports.models import proof
from advisor.simulators.compare import Compared
from advisor.words.problems import UnusableInputError
from tests.exports.models.test_orders import found

FILE = Aircraft(name="glider", model={"M_alpha": -40.0})


def flights(*numbers: int) -> GapFlights:
    return GapFlights([SimpleNamespace(number=n) for n in numbers], 0, ())


def answer(gap: float, verdict: str, maneuvers: tuple[int, ...], **changes: object):
    plain = found(**changes)
    by_maneuver = tuple((n, gap, 0.0) for n in maneuvers)
    return replace(plain, verdict=verdict, gap=replace(plain.gap, before=gap, by_maneuver=by_maneuver))


@pytest.fixture
def asked(monkeypatch):
    """What each diagnosis was asked: the manoeuvres and the aircraft file. A late command is found first."""
    seen = []

    def compared(flown, aircraft, simulator, holdout, progress, prior):
        numbers = tuple(m.number for m in flown.maneuvers)
        seen.append((numbers, aircraft))
        late = "transport_delay" in aircraft.effects
        told = answer(0.1 if late else 6.0, "none" if late else "effect", numbers)
        return Compared(told, aircraft)

    monkeypatch.setattr(proof, "compare_flown", compared)
    return seen


def test_the_last_third_flies_in_the_simulator_that_the_others_improved(asked):
    made = proof.prove(flights(1, 2, 3, 4, 5, 6), None, FILE)
    assert [numbers for numbers, _ in asked] == [(1, 2, 3, 4), (5, 6), (5, 6)]
    assert [bool(aircraft.effects) for _, aircraft in asked] == [False, False, True]
    assert (made.before, made.after) == (6.0, 0.1)
    assert made.by_maneuver == ((5, 6.0, 0.1), (6, 6.0, 0.1))
    assert made.is_closed


def test_another_log_flies_whole_and_the_fit_uses_all_of_the_first(asked):
    proof.prove(flights(1, 2, 3), flights(1, 2), FILE)
    assert [numbers for numbers, _ in asked] == [(1, 2, 3), (1, 2), (1, 2)]


def test_too_few_manoeuvres_are_refused_with_the_way_out(asked):
    with pytest.raises(UnusableInputError, match=r"2 of 4 manoeuvres apart.*--prove LOG"):
        proof.prove(flights(1, 2, 3, 4), None, FILE)
    assert not asked


def test_without_an_improvement_there_is_nothing_to_fly(monkeypatch):
    nothing = Compared(answer(0.0, "none", (1, 2, 3)), FILE)
    monkeypatch.setattr(proof, "compare_flown", lambda *_: nothing)
    with pytest.raises(
        UnusableInputError, match=r"no improved simulator to fly. The 3 manoeuvres of its fit say: \S"
    ):
        proof.prove(flights(1, 2, 3, 4, 5), None, FILE)


def test_people_read_the_gap_before_and_after_and_the_second_answer(asked):
    lines = list(proof.lines_of(proof.prove(flights(1, 2, 3, 4, 5, 6), None, FILE)))
    assert lines[0] == "Proof on manoeuvres 5, 6, which no fit has used: gap 6.00 → 0.10"
    assert lines[-1] == "  asked again, the improved simulator lacks: nothing above the noise"
