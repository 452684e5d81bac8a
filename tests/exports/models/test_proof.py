"""``advisor gap --prove``: the improved simulator flies manoeuvres that no fit has used."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap_flights import GapFlights
from advisor.exports.models.axes import prove_pitch as proof
from advisor.exports.models.axes.prove_pitch import as_it_ended
from advisor.exports.models.proof import lines_of, stays_of
from advisor.gap.diagnose import Examined
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.inference.findings import Findings, Model
from advisor.gap.kit.changes_between import breaks
from advisor.gap.records.prepare import prepare
from advisor.gap.result import Value
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, NUISANCES
from advisor.simulators.compare import Compared
from advisor.simulators.unseen import sized_without
from advisor.words.problems import UnusableInputError
from tests.exports.models.test_orders import found
from tests.maneuvers import changed
from tests.simulators.nonlinear import flown

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
    lines = list(lines_of(proof.prove(flights(1, 2, 3, 4, 5, 6), None, FILE)))
    assert lines[0] == "Proof on manoeuvres 5, 6, which no fit has used: gap 6 → 0.1"
    assert lines[-1] == "  asked again, the improved simulator lacks: nothing above the noise"


def test_a_change_in_flight_has_come_before_the_last_manoeuvres():
    maneuvers = flown(maneuvers=4)
    numbers = dict.fromkeys(DERIVATIVES, Value(-1.0, 0.1))
    ended = as_it_ended(
        found(
            maneuvers=tuple(m.number for m in maneuvers),
            model=numbers | {"Z_0": Value(0.0, 0.1)},
            effects={"mass_change": {"step": -0.2, "at_s": breaks(prepare(maneuvers, FILE))[1]}},
        ),
        maneuvers,
        FILE,
    )
    assert not ended.effects
    assert ended.model["M_alpha"].value == pytest.approx(-1.0 / 0.8)
    assert ended.model["Z_0"].value == 0.0


@pytest.fixture
def worse(monkeypatch):
    """A late command closes the gap; the fitted numbers open it again."""

    def compared(flown, aircraft, simulator, holdout, progress, prior):
        numbers = tuple(m.number for m in flown.maneuvers)
        given = aircraft.model["M_alpha"] == FILE.model["M_alpha"]
        gap = 2.0 if not aircraft.effects else 0.5 if given else 2.6
        return Compared(answer(gap, "effect", numbers), aircraft)

    monkeypatch.setattr(proof, "compare_flown", compared)


def test_a_part_with_which_the_gap_grows_is_taken_back_and_named(worse):
    made = proof.prove(flights(1, 2, 3, 4, 5, 6), None, FILE)
    assert (made.before, made.after, made.gap_with_them) == (2.0, 0.5, 2.6)
    assert made.taken_back == ("the fitted numbers",)
    stays = stays_of(made, answer(2.0, "effect", (1, 2)), FILE.model)
    assert stays.model["M_alpha"].value == FILE.model["M_alpha"]
    assert stays.effects
    assert stays.sentence.endswith(
        "Taken back: the fitted numbers, with which the gap is 2.6 instead of 0.5 on manoeuvres 5, 6, which "
        "no fit has used."
    )


def test_nothing_stays_where_each_part_makes_the_gap_worse(monkeypatch):
    def compared(flown, aircraft, simulator, holdout, progress, prior):
        gap = 2.0 if aircraft == FILE else 3.0
        return Compared(answer(gap, "effect", tuple(m.number for m in flown.maneuvers)), aircraft)

    monkeypatch.setattr(proof, "compare_flown", compared)
    made = proof.prove(flights(1, 2, 3, 4, 5, 6), None, FILE)
    assert (made.before, made.after, made.gap_with_them) == (2.0, 2.0, 3.0)
    assert not stays_of(made, answer(2.0, "effect", (1, 2)), FILE.model).improves


def test_few_manoeuvres_without_an_answer_fly_the_answer_of_all_with_their_own_sizes(monkeypatch):
    sized = []

    def compared(flown, aircraft, simulator, holdout, progress, prior):
        numbers = tuple(m.number for m in flown.maneuvers)
        late = "transport_delay" in aircraft.effects
        verdict = "unknown" if len(numbers) == 4 else "none"
        return Compared(answer(0.1 if late else 6.0, verdict, numbers), aircraft)

    def sized_without(found, kept):
        sized.append((found.findings, kept))
        return found

    monkeypatch.setattr(proof, "compare_flown", compared)
    monkeypatch.setattr(proof, "sized_without", sized_without)
    whole = Compared(answer(6.0, "effect", (1, 2, 3, 4, 5, 6)), FILE, "findings of all")
    made = proof.prove(flights(1, 2, 3, 4, 5, 6), None, FILE, whole=whole)
    assert sized == [("findings of all", [5, 6])]
    assert (made.before, made.after) == (6.0, 0.1)
    assert "  The correction is that of all manoeuvres; its sizes are fitted without those flown here." in (
        lines_of(made)
    )


@pytest.mark.parametrize("kept", [(), (3,)])
def test_sizes_are_those_of_a_fit_that_has_not_seen_the_manoeuvres_kept_apart(kept):
    """The third manoeuvre's elevator moved half as far as logged, which contradicts the other two."""
    *others, third = flown(maneuvers=3)
    logged = third.channels["elevator"]
    strange = changed(third, "elevator", y=2.0 * logged.y)

    def fitted(maneuvers):
        flights = prepare(maneuvers, FILE)
        own = np.zeros((len(flights), len(NUISANCES)))
        start = SearchPoint(np.array([-2.7, 0.0, -0.15, -23.0, -3.4, -29.0]), own)
        problem = EffectProblem(flights, np.zeros(len(ENTRIES)))
        return problem, fit(problem, start)

    problem, whole = fitted([*others, strange])
    plain = Model(whole, None)
    findings = Findings(problem, (plain,), None, None, np.ones(1), None, None, None)
    model = dict.fromkeys(DERIVATIVES, Value(0.0, 0.1))
    sized = sized_without(Examined(found(model=model, effects={}), findings), kept).diagnosis
    _, alone = fitted(others)
    told = sized.model["M_delta_e"].value
    assert (told == pytest.approx(alone.point.derivatives[5], rel=0.1)) == bool(kept)


def test_sizes_are_fitted_to_the_flight_of_their_model():
    """The elevator of one flight moved half as far as logged in the other, and so answers twice as much."""
    logged = flown(maneuvers=2)
    half = [changed(m, "elevator", y=0.5 * e.y) for m in logged if (e := m.channels["elevator"])]
    flights, others = (prepare(maneuvers, FILE) for maneuvers in (logged, half))
    start = SearchPoint(np.array([-2.7, 0.0, -0.15, -23.0, -3.4, -29.0]), np.zeros((2, len(NUISANCES))))
    problem = EffectProblem(flights, np.zeros(len(ENTRIES)))
    whole = fit(problem, start)
    own = Findings(problem, (Model(whole, None, None, others),), None, None, np.ones(1), None, None, None)
    model = dict.fromkeys(DERIVATIVES, Value(0.0, 0.1))
    sized = sized_without(Examined(found(model=model, effects={}), own), ()).diagnosis
    assert sized.model["M_delta_e"].value == pytest.approx(2.0 * whole.point.derivatives[5], rel=0.1)
