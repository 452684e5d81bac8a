"""A numerical fault in one manoeuvre, verdict or joint estimate leaves the rest of the campaign."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.whole_flights import read_whole
from advisor.campaign import axis_campaign, joint_estimate
from advisor.campaign import axis_campaign as elevator
from advisor.campaign import campaign as whole_campaign
from advisor.report.document import analysis_document
from tests.campaign.axes.test_lateral import ended, wired
from tests.flights import TWO, recorded


def broken(*_, **__):
    raise np.linalg.LinAlgError("Eigenvalues did not converge")


def breaking(function, call):
    """Return a function that fails at one of its calls, counted from 1."""
    calls = []

    def sometimes(*given, **named):
        calls.append(given)
        return broken() if len(calls) == call else function(*given, **named)

    return sometimes


def analysed(axis="pitch"):
    log = recorded("uav", 1.0, maneuvers=TWO)
    flights = read_whole([log], Aircraft(), axis=axis)
    return analysis_document(flights.state, [str(log)], Aircraft())


def parts_of(document):
    return [one["part"] for one in document["problems"] if one["code"] == "internal"]


def test_a_manoeuvre_of_the_elevator_that_fails_is_refused_and_the_others_are_judged(monkeypatch):
    def only_the_second(maneuver, *given):
        return broken() if maneuver.number == 2 else assess(maneuver, *given)

    assess = elevator.assess
    monkeypatch.setattr(elevator, "assess", only_the_second)
    document = analysed()
    assert document["usable"]
    assert parts_of(document) == ["pitch, manoeuvre 2"]
    second = document["maneuvers"][1]
    assert second["verdict"] == "rejected"
    assert second["reasons"][0]["code"] == "internal"
    assert second["estimates"] is None
    assert document["maneuvers"][0]["verdict"] == "accepted"
    assert document["model"]["M_alpha"]["value"] is not None


def test_a_joint_estimate_that_fails_leaves_the_verdicts(monkeypatch):
    monkeypatch.setattr(joint_estimate, "fit_jointly", broken)
    document = analysed()
    assert document["model"] is None
    assert "pitch, joint estimate" in parts_of(document)
    assert any(one["verdict"] == "accepted" for one in document["maneuvers"])


def test_verdicts_that_fail_accept_nothing(monkeypatch):
    monkeypatch.setattr(axis_campaign, "judge_campaign", broken)
    document = analysed()
    assert parts_of(document) == ["pitch, verdicts"]
    assert {one["verdict"] for one in document["maneuvers"]} == {"rejected"}
    assert document["flight_test"]["decision"] == "continue"


def test_instruments_that_fail_leave_the_model(monkeypatch):
    monkeypatch.setattr(whole_campaign, "with_fit", broken)
    document = analysed()
    assert parts_of(document) == ["instruments"]
    assert document["instruments"] == []
    assert document["model"] is not None


def test_a_lateral_manoeuvre_that_fails_leaves_the_other(monkeypatch):
    monkeypatch.setattr(axis_campaign, "estimate_axis", breaking(axis_campaign.estimate_axis, 1))
    state = ended(wired())
    first, second = state.maneuvers
    assert not first.verdict.accepted
    assert first.verdict.reasons[0].code == "internal"
    assert "lateral, manoeuvre 1" in first.verdict.sentence
    assert second.verdict.accepted


@pytest.mark.study
@pytest.mark.timeout(600)
@pytest.mark.parametrize("log", ["arduplane-default-rates.tlog", "bundled-demo.tlog"])
def test_no_part_fails_on_a_log_of_this_repository(log, request):
    path = request.config.rootpath / "logs" / log
    assert read_whole([path], Aircraft(), axis="both").state.failed == ()
