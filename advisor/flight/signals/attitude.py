"""ATTITUDE made from ATTITUDE_QUATERNION, for vehicles that send no ATTITUDE."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.flight.signals.messages import Columns, cut, joined
from advisor.process.arrays import FloatArray

_QUATERNION = ("q1", "q2", "q3", "q4")


class Attitudes:
    """Conversion of quaternions to ATTITUDE for each component without ATTITUDE messages.

    If a component sends both messages, its quaternions are used until its first ATTITUDE. The order of
    arrival decides, so batches of any size give equal results.
    """

    def __init__(self) -> None:
        self._senders: set[tuple[int, int]] = set()
        """System and component ids that have sent an ATTITUDE."""

    def of(self, columns: Sequence[Columns]) -> Sequence[Columns]:
        """Return the columns with an ATTITUDE in place of every quaternion before the first ATTITUDE."""
        sent = {_sender(c): c for c in columns if c.name == "ATTITUDE" and len(c)}
        stand_ins: dict[tuple[int, int], Columns] = {}
        for c in columns:
            sender = _sender(c)
            if c.name != "ATTITUDE_QUATERNION" or sender in self._senders:
                continue
            rows = int(np.searchsorted(c.order, sent[sender].order[0])) if sender in sent else len(c)
            if rows:
                early = _as_attitude(c, rows)
                stand_ins[sender] = joined([early, sent[sender]]) if sender in sent else early
        self._senders.update(sent)
        if not stand_ins:
            return columns
        others = [c for c in columns if c.name != "ATTITUDE" or _sender(c) not in stand_ins]
        return [*stand_ins.values(), *others]


def euler_angles(q: FloatArray) -> dict[str, FloatArray]:
    """Return roll, pitch and yaw of attitude quaternions, rad, each of shape (n,).

    Parameters
    ----------
    q
        Shape (4, n): components w, x, y, z of the rotation from north-east-down into body axes.
    """
    w, x, y, z = q
    return {
        "roll": np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        "pitch": np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0)),
        "yaw": np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    }


def _sender(c: Columns) -> tuple[int, int]:
    return c.system, c.component


def _as_attitude(c: Columns, rows: int) -> Columns:
    """Return the given rows as ATTITUDE; ``q1`` to ``q4`` are w, x, y, z of the rotation into body axes."""
    early = cut(c, slice(rows))
    angles = euler_angles(np.array([early.fields[name] for name in _QUATERNION], dtype=np.float64))
    others = (*_QUATERNION, "repr_offset_q")
    kept = {name: values for name, values in early.fields.items() if name not in others}
    return replace(early, name="ATTITUDE", fields=kept | angles)
