"""Limits of roll and yaw on both sides of their numbers, and parts that are missing."""

from math import pi

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.lateral_requirements import lateral_levels, lateral_qualification
from advisor.decision.axes.lateral_stop import FlownInput, lateral_flight_test
from advisor.decision.axes.requirements import judge
from advisor.decision.history import Heard
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.model.axes.lateral import Trim
from advisor.oem.estimate import NoEstimate
from advisor.oem.flying_qualities import Quality
from tests.campaign.side_builders import estimate
from tests.oem.axis.builders import JET, vector

NONE = NoEstimate("singular", "nothing was told")
W = 0.8 * pi
T = np.linspace(0.0, 10.0, 1001)
"""Four whole periods of W."""


def rolling(without: str = "", **moved: np.ndarray) -> Maneuver:
    """A record in which roll and yaw rate swing alike; other channels move as given."""
    swing = 0.2 * np.sin(W * T)
    moved = {"p": swing, "r": swing, "bank": 0.1 * swing, "aileron": 0.05 * np.sin(W * T), **moved}
    channels = {
        name: Channel(name, T, y, "ATTITUDE", "measured") for name, y in moved.items() if name != without
    }
    return Maneuver(1, 0, Span(0.0, 1.0, 4.0, 10.0, "aileron doublet", (), "quiet"), channels)


def codes(record: Maneuver) -> list[str]:
    return [reason.code for reason in judge("lateral", record, NONE, Aircraft())]


@pytest.mark.parametrize(("share", "refused"), [(0.18, False), (0.22, True)])
def test_pitching_makes_at_most_a_fifth_of_the_moments(share: float, refused: bool) -> None:
    """Where roll and yaw swing alike at W, a pitch rate q makes q/W of the angular acceleration."""
    nodding = share * W * np.where(np.arange(len(T)) % 2, 1.0, -1.0)
    assert ("coupling" in codes(rolling(q=nodding))) is refused
    assert ("coupling" in codes(rolling(q=nodding + 0.5))) is refused


@pytest.mark.parametrize("without", ["p", "q", "r"])
def test_without_one_of_the_rates_nothing_is_said_of_coupling(without: str) -> None:
    assert "coupling" not in codes(rolling(without, q=9.0 * np.sin(3.0 * T)))


@pytest.mark.parametrize("rudder", [None, np.zeros(0)], ids=["missing", "empty"])
def test_a_control_that_was_not_recorded_has_not_moved(rudder: np.ndarray | None) -> None:
    record = rolling()
    if rudder is not None:
        record.channels["rudder"] = Channel("rudder", rudder, rudder, "SERVO", "measured")
    flown = FlownInput.of(record, ())
    assert flown.control == "aileron"
    assert flown.amplitude_rad == pytest.approx(0.05, rel=1e-3)


def test_a_dutch_roll_has_a_level_only_where_both_of_its_numbers_are_told() -> None:
    names = "dutch_roll_omega", "dutch_roll_zeta", "roll_time_constant", "spiral_pole"
    whole = {name: Quality(value, 0.0) for name, value in zip(names, (3.0, 0.5, 0.5, -0.01), strict=True)}
    assert "dutch_roll" in lateral_levels(whole)[0].by_mode
    for part in ("dutch_roll_omega", "dutch_roll_zeta"):
        others = {name: quality for name, quality in whole.items() if name != part}
        assert "dutch_roll" not in lateral_levels(others)[0].by_mode


def test_a_slow_roll_may_be_off_by_two_degrees_a_second() -> None:
    roll = lateral_qualification(vector(JET), vector(JET), Trim(130.0), 0.01, 1.0)[0]
    assert abs(roll.flown) < 20.0
    assert roll.limit == 2.0


def test_without_a_dutch_roll_of_both_only_the_roll_rate_is_compared() -> None:
    stiff, loose = vector(JET), vector(JET | {"N_beta": -9.0})
    for one, other in ((stiff, loose), (loose, stiff)):
        tests = lateral_qualification(one, other, Trim(130.0), 0.1, 1.0)
        assert [test.entry for test in tests] == ["2.d.2"]


def test_what_the_crew_heard_after_each_manoeuvre_is_kept_and_the_newest_value_comes_last() -> None:
    both = estimate("aileron", "rudder", percent=9.0)
    flown = [estimate("aileron"), estimate("rudder")]
    heard = [Heard({"information": 900.0}, frozenset()), Heard({"information": 300.0}, frozenset())]
    assert (
        len(lateral_flight_test(flown, both, Aircraft(), heard=heard).by_rule["information"].history_percent)
        == 2
    )
    first = lateral_flight_test(flown, both, Aircraft(), heard=heard[:1]).by_rule["information"]
    assert first.history_percent == (900.0, first.now_percent)


def test_nothing_is_forecast_while_a_control_or_an_error_is_lacking() -> None:
    both = estimate("aileron", "rudder", percent=9.0)

    def remaining(*flown: str, joint=both):
        return lateral_flight_test([estimate(one) for one in flown], joint, Aircraft()).next.remaining

    assert remaining("aileron", "rudder") is not None
    assert remaining("aileron", "aileron") is None
    assert (
        remaining("aileron", "rudder", joint=estimate("aileron", "rudder", untold={"L_p": "collinear"}))
        is None
    )
