"""How long the watch over the instruments examines what the aircraft does."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.flight.instruments import examined as examining
from advisor.flight.stream import state
from advisor.flight.stream.state import InstrumentWatch


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
