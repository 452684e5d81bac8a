"""What vehicles say in words comes whole, printable, bounded, with severity and sender."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.flight.instruments import examined as examining
from advisor.flight.maneuvers.maneuver import VehicleSaid
from advisor.flight.signals.messages import Columns
from advisor.flight.stream import state
from advisor.flight.stream.identity import READER
from advisor.flight.stream.state import InstrumentWatch, VehicleTexts
from advisor.flight.vehicle.following import FOLLOW


def statustext(
    *texts: bytes, severity: int = 4, id: int | None = None, first: int = 0, component: int = 1
) -> Columns:
    n = len(texts)
    fields = {"severity": np.full(n, severity), "text": np.array(texts, dtype="S256")}
    if id is not None:
        fields |= {"id": np.full(n, id), "chunk_seq": np.arange(first, first + n)}
    return Columns("STATUSTEXT", 1, component, np.arange(n), np.zeros(n), fields)


def said(*heard: Columns) -> list[VehicleSaid]:
    texts = VehicleTexts()
    return [one for columns in heard for one in texts.heard(columns, 80.0)] + list(texts.finish(81.0))


def test_a_text_comes_with_its_severity_its_sender_and_the_vehicles_time():
    assert said(statustext(b"EKF variance", component=7)) == [
        VehicleSaid("EKF variance", "warning", 1, 7, 80.0)
    ]


def test_the_chunks_of_a_text_are_joined():
    heard = said(statustext(b"a" * 50, b"b" * 50, b"c", id=3))
    assert [one.text for one in heard] == ["a" * 50 + "b" * 50 + "c"]


def test_a_text_whose_last_chunk_is_lost_is_told_when_the_next_one_comes():
    heard = said(statustext(b"a" * 50, id=3), statustext(b"next", id=0))
    assert [one.text for one in heard] == ["a" * 50, "next"]


def test_a_text_whose_last_chunk_never_comes_is_told_at_the_end():
    assert [one.at_s for one in said(statustext(b"a" * 50, id=3))] == [81.0]


def test_chunks_of_two_senders_are_kept_apart():
    texts = VehicleTexts()
    heard = [
        one.text
        for columns in (
            statustext(b"a" * 50, id=3),
            statustext(b"b" * 50, id=3, component=2),
            statustext(b"1", id=3, first=1),
            statustext(b"2", id=3, first=1, component=2),
        )
        for one in texts.heard(columns, 0.0)
    ]
    assert heard == ["a" * 50 + "1", "b" * 50 + "2"]


def test_escape_sequences_and_what_follows_a_null_are_left_out():
    assert [one.text for one in said(statustext(b"\x1b[2Jgust\x07 ahead\0junk"))] == ["[2Jgust ahead"]


def test_no_text_is_longer_than_an_event_log_can_show():
    (one,) = said(statustext(*[b"x" * 50] * 200, b"end", id=3))
    assert len(one.text) == 250
    assert one.text.endswith("…")


@pytest.mark.parametrize("own", [READER + b"the log begins late", FOLLOW + b"2", b"", b"\0\0"])
def test_what_the_advisor_wrote_itself_and_empty_texts_are_no_texts_of_a_vehicle(own: bytes):
    assert said(statustext(own)) == []


def test_a_log_that_keeps_no_severity_has_none():
    assert [one.severity for one in said(statustext(b"Ready", severity=255))] == [""]


@pytest.mark.parametrize(("evidence", "stretches"), [({"theta_scale": None}, 6), ({}, 29)])
def test_the_watch_ends_after_six_stretches_with_motion(monkeypatch, evidence, stretches):
    made = []
    examined = SimpleNamespace(evidence=evidence, findings=())
    monkeypatch.setattr(state, "examine", lambda *_: made.append(1) or examined)
    monkeypatch.setattr(state, "examine_side", lambda *_: SimpleNamespace(evidence={}, findings=()))
    monkeypatch.setattr(examining, "pooled", lambda _: {})
    watch = InstrumentWatch(lambda name, since_s, until_s: SimpleNamespace(t=np.array([since_s, until_s])))
    watch.advance(0.0, 300.0)
    assert len(made) == stretches
