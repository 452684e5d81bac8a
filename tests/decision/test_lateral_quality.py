"""Objections to a lateral manoeuvre, on hand-made records."""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.lateral_quality import judge_lateral
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.instrument_finding import InstrumentFinding
from advisor.flight.signals.record import Channel
from advisor.oem.estimate import NoEstimate

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
    (reason,) = judge_lateral(maneuver(REVERSED), NONE, Aircraft())
    assert reason.code == "a_y_sign"
    assert reason.by_instrument


def test_a_contradiction_that_the_estimate_allows_for_is_no_reason():
    codes = [r.code for r in judge_lateral(maneuver(replace(REVERSED, used=True)), NONE, Aircraft())]
    assert "a_y_sign" not in codes
