"""Objections to a lateral manoeuvre, on hand-made records."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.axes.requirements import judge
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import InstrumentFinding
from advisor.model.axes.lateral import LATERAL
from advisor.oem.estimate import ChannelFit, NoEstimate
from tests.campaign.side_builders import estimate
from tests.rows import row

T = np.arange(0.0, 10.0, 0.02)
REVERSED = InstrumentFinding(
    "a_y", "sign", "right", "left", contradicts=True, text="the side force has the wrong sign", fix="turn it"
)
NONE = NoEstimate("singular", "nothing was told")


def maneuver(*findings):
    moved = {"p": np.sin(T), "r": 0.1 * np.sin(T), "bank": 0.1 * np.cos(T), "aileron": 0.05 * np.sin(T)}
    channels = {name: Channel(name, T, y, "ATTITUDE", "measured") for name, y in moved.items()}
    span = Span(0.0, 1.0, 4.0, 10.0, "aileron doublet", (), "quiet")
    return Maneuver(1, 0, span, channels, findings=findings)


def test_a_contradiction_of_an_instrument_is_the_one_reason():
    (reason,) = judge("lateral", maneuver(REVERSED), NONE, Aircraft())
    assert reason.code == "a_y_sign"
    assert reason.by_instrument


def test_a_contradiction_that_the_estimate_allows_for_is_no_reason():
    codes = [r.code for r in judge("lateral", maneuver(replace(REVERSED, used=True)), NONE, Aircraft())]
    assert "a_y_sign" not in codes


def flown(kind="rudder doublet", closed_by="quiet", free_s=6.0, level=0.0, size=1.0):
    """Return a record of a rudder input at 1 to 4 s, with a free response of this length."""
    yawing = size * 0.1 * np.sin(3.0 * T)
    moved = {"p": yawing, "r": yawing, "bank": 0.1 * np.cos(T), "rudder": 0.05 * (T > 1.0)}
    channels = {name: Channel(name, T, y, "ATTITUDE", "measured") for name, y in moved.items()}
    span = Span(0.0, 1.0, 4.0, 4.0 + free_s, kind, ((1.0, 0.05), (4.0, level)), closed_by)
    return Maneuver(1, 0, span, channels)


def told(untold=(), band=0.05, noise=1e-4):
    """Return an estimate of the jet's rudder with relative errors of 2 %."""
    yaw = Channel("r", T, 0.1 * np.sin(3.0 * T), "ATTITUDE", "measured")
    error = noise * np.random.default_rng(3).standard_normal(len(T))
    fits = ({name: ChannelFit(name, T, yaw.y + error, yaw.y, noise) for name in ("p", "r")},)
    whole = estimate("rudder", untold=dict.fromkeys(untold, "collinear"), fits=fits)
    return replace(whole, prediction={"p": band, "r": band})


def codes(record, found):
    return [reason.code for reason in judge("lateral", record, found, Aircraft())]


@pytest.mark.parametrize("cause", ["end of log", "gap", "mode change"])
def test_a_record_that_ends_within_its_input_is_no_test_however_much_it_determines(cause):
    assert codes(flown(closed_by=cause, free_s=0.4, level=0.05), told()) == ["aborted"]


@pytest.mark.parametrize("name", ["N_beta", "N_r", "N_delta_r"])
def test_a_short_free_response_counts_only_where_stiffness_damping_and_control_are_known(name):
    assert codes(flown(free_s=0.3), told(untold=[name])) == ["free_response"]
    assert codes(flown(free_s=6.0), told(untold=[name])) == []


NOTHING = told(untold=LATERAL.names.reported)


@row("a rudder test that determines its derivatives counts", flown(), told(), [])
@row("with a short free response it counts too", flown(free_s=0.3), told(), [])
@row(
    "a short free response with an unsure rate is refused",
    flown(free_s=0.3), told(band=0.3), ["free_response", "information"],
)  # fmt: skip
@row("a trimming movement that determines no derivative is no test", flown("other"), NOTHING, ["information"])
@row("a dutch roll release that determines none is a test", flown("dutch roll release"), NOTHING, [])
@row("a rate may exceed its noise by little", flown(), told(noise=0.008), [])
@row("a rate that hardly exceeds its noise is too gentle", flown(), told(noise=0.009), ["amplitude"])
@row("a yaw rate above one degree a second is enough", flown(size=0.175), told(), [])
@row("a yaw rate below one degree a second is too gentle", flown(size=0.173), told(), ["amplitude"])
@row("stamps that leap are the one reason", replace(flown(), leapt_s=7200.0), told(), ["clock"])
@row(
    "a short record of which the advisor missed a part blames the advisor",
    replace(flown(free_s=0.3), missed_s=2.0), told(untold=["N_beta"]), ["advisor_down"],
)  # fmt: skip
def test_a_lateral_record_and_its_estimate_have_these_reasons(record, found, reasons):
    assert codes(record, found) == reasons


def test_a_poor_record_is_told_how_much_more_of_its_control_to_use():
    (reason,) = judge("lateral", flown(), told(band=0.5), Aircraft())
    assert reason.code == "information"
    assert reason.text.endswith("use about 2.2 times the rudder")
