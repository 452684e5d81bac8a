"""A parameter is unresolved when a direction about which the data say nothing is more than 1 % its own."""

import numpy as np
import pytest

from advisor.model.axis import Names
from advisor.oem.covariance import influence
from advisor.oem.rows import Laid

NAMES = Names(("p",), ("one", "other", "third"), ("trim",), ("one", "other", "third"))


@pytest.mark.parametrize(("share", "unresolved"), [(0.008, False), (0.012, True)])
def test_a_share_of_one_per_cent_in_an_open_direction_is_too_much(share, unresolved):
    """Unit columns one, other and third with w·(other - one) = v·third are open along (w, -w, v)."""
    v, w = np.sqrt(share), np.sqrt((1.0 - share) / 2.0)
    half = 0.5 * v / w
    rest = np.sqrt(1.0 - half**2)
    columns = np.array([[-half, half, 1.0, 0.0], [rest, rest, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    laid = Laid(
        names=NAMES, z=np.zeros(3), t=np.arange(3.0), rows=({"p": slice(0, 3)},),
        channel=np.zeros(3, np.int64), owner=np.zeros(3, np.int64), free=np.arange(4),
    )  # fmt: skip
    found = influence(laid, columns, np.ones(1))
    assert found.unresolved == (("one", "other", "third") if unresolved else ("one", "other"))
