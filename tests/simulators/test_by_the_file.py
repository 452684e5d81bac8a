"""The gap of a corrected file on manoeuvres kept apart."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.simulators import unseen


def test_natural_numbers_of_a_corrected_file_start_from_its_own_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    # From the fit without the effect, a latency at its bound ended 39 ms off next to a delay of 60 ms.
    started: list[str] = []

    def predicted(problem, model, fitted, floor, kept, offset_rad):
        started.append(fitted.name)
        return SimpleNamespace(mean_square=np.ones(4))

    def fit(name):
        point = SimpleNamespace(own=None)
        return SimpleNamespace(fitted=SimpleNamespace(name=name, point=point))

    plain, corrected = fit("plain"), fit("corrected")
    findings = SimpleNamespace(
        problem=SimpleNamespace(prior_derivatives=np.zeros(6)), models=[plain, corrected], last=corrected
    )
    examined = SimpleNamespace(diagnosis=None, findings=findings)
    monkeypatch.setattr(unseen, "predicted", predicted)
    monkeypatch.setattr(unseen, "changes_something", lambda _: True)
    monkeypatch.setattr(unseen, "unknown_offset", lambda *_: 0.0)
    monkeypatch.setattr(unseen, "as_changed", lambda *_: None)
    monkeypatch.setattr(unseen, "floor_of", lambda _: np.ones(4))
    unseen.by_the_file(examined, unseen.UnseenManeuvers((0,), examined))
    assert started == ["plain", "corrected"]
