"""A numerical fault inside the diagnosis of one axis is a value that names its part."""

import json
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis import gap as pitch_logs
from advisor.analysis import whole_flights
from advisor.analysis.gap_flights import GapFlights
from advisor.cli import axis_gap
from advisor.gap import diagnose
from advisor.gap.axis import comparison
from advisor.session.diagnosis import GapTask
from tests.campaign.side_builders import judged
from tests.campaign.side_builders import state as side_state
from tests.gap.generator import Setup, fly

LOG = Path(__file__).parents[2] / "logs" / "bundled-demo.tlog"
EACH = pytest.mark.parametrize(
    ("axis", "module", "name", "fault"),
    [
        ("pitch", diagnose, "infer", np.linalg.LinAlgError("Eigenvalues did not converge")),
        ("pitch", diagnose, "prepare", ZeroDivisionError("float division by zero")),
        ("lateral", comparison, "case_of", np.linalg.LinAlgError("Singular matrix")),
    ],
)


@pytest.fixture(autouse=True)
def read_already(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two manoeuvres of the elevator and two of roll and yaw in place of those of the log."""
    flown = GapFlights(fly(Setup(maneuvers=2, seed=4)), 0, ())
    monkeypatch.setattr(pitch_logs, "maneuvers_of", lambda *_, **__: flown)
    read = SimpleNamespace(
        state=SimpleNamespace(lateral=side_state(judged(1, "aileron"), judged(2, "rudder")))
    )
    for reader in (whole_flights, axis_gap):
        monkeypatch.setattr(reader, "read_whole", lambda *_, **__: read)


def break_at(monkeypatch: pytest.MonkeyPatch, module: ModuleType, name: str, fault: Exception) -> None:
    def broken(*_: object, **__: object) -> None:
        raise fault

    monkeypatch.setattr(module, name, broken)


def failed_parts(document: Mapping[str, Any]) -> list[str]:
    return [one["part"] for one in document["problems"] if one["code"] == "internal"]


@EACH
def test_the_command_answers_with_the_part_that_failed(advisor, monkeypatch, axis, module, name, fault):
    break_at(monkeypatch, module, name, fault)
    done = advisor("gap", LOG, "--axis", axis, "--json")
    assert done.returncode == 0
    document = json.loads(done.stdout)
    assert document["usable"]
    assert failed_parts(document) == [f"{axis}, diagnosis"]
    assert f"{type(fault).__name__}: {fault}" in document["problems"][0]["text"]
    assert document["gap"] is None
    assert f"{axis}, diagnosis" in done.stderr
    assert "Traceback" not in done.stderr


@EACH
def test_the_diagnosis_of_the_screens_answers_with_the_part_that_failed(
    monkeypatch: pytest.MonkeyPatch, axis: str, module: ModuleType, name: str, fault: Exception
) -> None:
    break_at(monkeypatch, module, name, fault)
    document = GapTask((LOG,), Aircraft(), sideways=axis == "lateral").done()
    assert failed_parts(document) == [f"{axis}, diagnosis"]
    assert document["gap"] is None
