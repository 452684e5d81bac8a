"""Parameters that a ground station fetches by MAVLink FTP are heard on a live link, too."""

from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.flight.signals.messages import cut
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.logs.parameter_file import MESSAGE
from advisor.session.live import LinkSource
from tests.mavlink.logs.test_parameter_file import PARAMETERS, answer, log, packed, pieces


def heard(batches):
    """Return the parameters of each batch that a live source delivers."""
    waiting = iter(batches)
    source = LinkSource(nullcontext(SimpleNamespace(read=lambda _: next(waiting))))
    return [_stated(source.read(0.0)) for _ in batches]


def _stated(batch):
    return {
        raw.decode(): float(value)
        for c in batch
        if c.name == "PARAM_VALUE"
        for raw, value in zip(c.fields["param_id"], c.fields["param_value"], strict=True)
    }


def one_by_one(path: Path, messages):
    whole = [c for batch in open_log(log(path, messages)) for c in batch if c.name == MESSAGE]
    return [[cut(c, np.arange(len(c)) == k)] for c in whole for k in range(len(c))]


def test_each_piece_is_followed_by_the_parameters_known_by_then(tmp_path: Path):
    data = packed(PARAMETERS, False)
    told = heard(one_by_one(tmp_path / "a.tlog", [answer(0, 128, 4, 0, b""), *pieces(data)]))
    assert told[0] == {}
    assert told[-1] == {name: pytest.approx(value) for name, _, value in PARAMETERS}
    assert [len(t) for t in told] == sorted(len(t) for t in told)


def test_a_piece_that_comes_twice_states_nothing_anew(tmp_path: Path):
    sent = pieces(packed(PARAMETERS, False))
    told = heard(one_by_one(tmp_path / "a.tlog", [*sent, sent[0], sent[1]]))
    assert told[-2:] == [{}, {}]


def test_another_file_states_nothing(tmp_path: Path):
    told = heard(one_by_one(tmp_path / "a.tlog", pieces(b"a mission, not parameters at all")))
    assert told == [{}] * len(told)
