"""A correction that raises the gap of manoeuvres kept apart leaves the answer and its simulator."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from advisor.gap.alternative import Alternative
from advisor.gap.diagnose import Examined
from advisor.gap.inference.findings import Added, Model
from advisor.simulators.unseen import UnseenManeuvers, without_raised, without_worse
from tests.exports.models.test_orders import found as improvable

NUMBERED = SimpleNamespace(
    flights=SimpleNamespace(flights=[SimpleNamespace(number=n) for n in (1, 2, 3)]), channels=("q",)
)


LAG = Alternative("effect", "actuator_lag", "input")


@dataclass(frozen=True)
class Found:
    """Findings whose models count by their number."""

    models: tuple[Model, ...]
    problem: object

    @property
    def added(self) -> tuple[Added, ...]:
        return tuple(model.added for model in self.models if model.added is not None)


@dataclass(frozen=True)
class Measured:
    gap_before: float
    gap_after: float
    on_paper: tuple[str, ...] = ()


def answer(*named: str, in_turn: tuple[float, ...] = ()) -> Examined:
    """Return a diagnosis with these effects, which can also be told with fewer of them.

    ``in_turn`` has the gap of the manoeuvres held out in turn, with no effect, with one, and so on.
    """
    gaps = in_turn or (0.0,) * (len(named) + 1)
    models = tuple(
        Model(None, SimpleNamespace(mean_square=np.array([gap + 1.0])), None if name is None else Added(name))
        for gap, name in zip(gaps, (*named, None), strict=False)
    )
    findings, found = Found(models, NUMBERED), improvable()
    causes = tuple(replace(cause, present=bool(named)) for cause in found.causes)
    found = replace(found, gap=replace(found.gap, floor={"q": 1.0}), causes=causes, answer=LAG)
    return Examined(found, findings, lambda most: answer(*named[:most], in_turn=gaps))


def taken(gaps: dict[int, float], *named: str, given: float = 659.0):
    """Return the diagnosis without what is worse, where each number of effects has a gap."""
    unseen = UnseenManeuvers((1,), answer(*named))
    return without_worse(answer(*named), unseen, lambda u: Measured(given, gaps[len(u.examined.named)]))


def test_effects_after_the_set_with_the_least_gap_leave_the_answer_and_are_named():
    """JSBSim's c172 as given has a gap of 659; each further effect raises that of its servo's lag."""
    stays, measured = taken({0: 400.0, 1: 0.272, 2: 7.53, 3: 6.86}, "actuator_lag", "mass_change", "icing")
    assert stays.named == ("actuator_lag",)
    assert measured.gap_after == 0.272
    assert stays.diagnosis.taken_back == (
        "Taken back: mass change and icing, with which the gap is 6.86 instead of 0.272 on manoeuvre 2, "
        "which no fit has used.",
    )
    assert stays.diagnosis.improves


def test_an_effect_that_raises_the_gap_held_out_in_turn_leaves_first():
    """JSBSim's c172 by the wrong servo: a nonlinear moment raises the gap from .268 to .376."""
    whole = answer("actuator_lag", "nonlinear_pitching_moment", in_turn=(3.0, 0.268, 0.376))
    stays = without_raised(whole)
    assert stays.named == ("actuator_lag",)
    assert stays.diagnosis.taken_back == (
        "Taken back: nonlinear pitching moment, with which the gap is 0.376 instead of 0.268 on manoeuvres "
        "held out in turn.",
    )
    assert without_raised(answer("actuator_lag", in_turn=(0.2, 0.24))).named == ("actuator_lag",)


def test_what_is_taken_back_moves_no_probability():
    whole = answer("actuator_lag", "mass_change")
    stays, _ = taken({0: 400.0, 1: 0.2, 2: 7.0}, "actuator_lag", "mass_change")
    assert stays.named == ("actuator_lag",)
    assert stays.diagnosis.probabilities == whole.diagnosis.probabilities
    assert stays.diagnosis.verdict == whole.diagnosis.verdict


def test_an_answer_that_lowers_the_gap_stays_whole():
    stays, measured = taken({0: 40.0, 1: 0.2, 2: 0.19}, "actuator_lag", "mass_change")
    assert stays.named == ("actuator_lag", "mass_change")
    assert measured.gap_after == 0.19
    assert stays.diagnosis.taken_back == ()


def test_no_flight_contradicts_a_correction_that_the_simulator_cannot_take():
    """A simulator keeps its own delay: its gap with the rest of the answer tells nothing of the whole."""
    whole = answer("transport_delay")
    unseen = UnseenManeuvers((1,), whole)
    stays, measured = without_worse(whole, unseen, lambda _: Measured(8.6, 9.9, ("its own servo",)))
    assert stays is whole
    assert measured.gap_after == 9.9


def test_a_difference_that_nobody_sees_takes_nothing_back():
    stays, _ = taken({0: 40.0, 1: 0.2, 2: 0.24}, "actuator_lag", "mass_change")
    assert stays.named == ("actuator_lag", "mass_change")


def test_a_correction_that_makes_the_simulator_worse_is_the_answer_without_an_improved_simulator():
    stays, _ = taken({0: 3.0, 1: 2.5}, "actuator_lag", given=2.0)
    assert stays.diagnosis.verdict == "effect"
    assert not stays.diagnosis.improves
    assert stays.diagnosis.shrink is None
    assert stays.diagnosis.taken_back[0].startswith("Taken back: every correction, with which the gap")
