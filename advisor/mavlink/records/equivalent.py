"""Messages that are equivalent to the records in an autopilot's own log.

Autopilots log angles, rates, outputs and air data as separate records, each at its own time. Records of a
log become messages of a telemetry link, so that all later code has one path. A message contains only values
of its own record. Missing and infinite values are NaN in a floating-point field, and zero otherwise. Nothing
is interpolated.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.flight.signals.messages import Columns
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.mends import Carrier

AUTOPILOT_COMPONENT = 1  # MAV_COMP_ID_AUTOPILOT1
MAV_TYPE_FIXED_WING = 1
MAV_PARAM_TYPE_REAL32 = 9


def message(
    name: str,
    system: int,
    order: IntArray,
    arrival_s: FloatArray,
    fields: Mapping[str, ArrayLike],
    carrier: Carrier,
) -> Columns:
    """Return messages of one type from the given values, sorted by their order.

    Parameters
    ----------
    name : str
        A key of ``DEFINITIONS``.
    system : int
        System id of the vehicle.
    order, arrival_s : shape (n,)
        Arrival index and time of each message, in the order of the fields.
    fields : mapping
        Values of each field, shape (n,) or a scalar for all, in the units of the definition, by name.
        Integers are cut to the size of the field, because a vehicle's counters wrap. Texts, floating-point
        values and fields that the definition lacks (a stamp) are unchanged.
    carrier : Carrier
        Kind of log from which the messages come.
    """
    n = len(order)
    layout = DEFINITIONS[name].layout
    is_sorted = n < 2 or bool(np.all(order[1:] > order[:-1]))
    rows = slice(None) if is_sorted else np.argsort(order)
    columns: dict[str, NDArray[Any]] = {}
    for field in layout.names or ():
        wire = layout[field]
        if field not in fields:
            nothing = np.nan if wire.base.kind == "f" else np.zeros((), wire.base)
            columns[field] = np.broadcast_to(nothing, (n, *wire.shape))
            continue
        values = np.asarray(fields[field])
        if wire.base.kind in "iu" and values.dtype.kind != "f":
            values = values.astype(wire.base)
        if values.dtype.kind == "f" and np.isinf(values).any():
            values = np.where(np.isinf(values), np.nan, values)
        columns[field] = np.broadcast_to(values, (n, *wire.shape))[rows if values.ndim else slice(None)]
    for field in fields.keys() - columns.keys():
        columns[field] = np.asarray(fields[field])[rows]
    return Columns(name, system, AUTOPILOT_COMPONENT, order[rows], arrival_s[rows], columns, carrier)


def side_by_side(*records: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return the fields of several records in separate rows, with NaN for fields that a record lacks.

    Parameters
    ----------
    records
        Values of each field of record k, shape (n_k,), by the field's name. Every record contains the stamps.
    """
    rows = [len(next(iter(record.values()))) for record in records]
    return {
        name: np.concatenate(
            [record.get(name, np.full(n, np.nan)) for record, n in zip(records, rows, strict=True)]
        )
        for name in dict.fromkeys(name for record in records for name in record)
    }


def air_data(*records: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return fields of VFR_HUD from records of air speed, climb rate and throttle, NaN without a throttle."""
    fields = side_by_side(*records)
    return {"throttle": np.full(len(next(iter(fields.values()))), np.nan), **fields}


def system_id(parameter: object) -> int:
    """Return the system id from a parameter's value; 1 for an invalid one."""
    return int(parameter) if isinstance(parameter, int | float) and 1 <= parameter <= 255 else 1


def milliseconds(time_us: IntArray) -> IntArray:
    """Return microseconds rounded to milliseconds."""
    return (time_us + 500) // 1000


def latest(at: IntArray, order: IntArray, values: NDArray[Any]) -> FloatArray:
    """Return the newest of ``values`` before each index ``at``.

    Parameters
    ----------
    at : shape (n,)
        Arrival indices at which values are needed.
    order, values : shape (m,)
        Rising arrival indices, and the values that arrived there.

    Returns
    -------
    shape (n,)
        NaN before the first value.
    """
    padded = np.concatenate([[np.nan], np.asarray(values, dtype=np.float64)])
    return padded[np.searchsorted(order, at, side="right")]


def nearest(at_us: IntArray, time_us: IntArray) -> IntArray:
    """Return the index of the record nearest to each given time. Of two equally near records, return the
    earlier.
    """
    after = np.clip(np.searchsorted(time_us, at_us), 1, max(len(time_us) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(time_us) - 1)
    return np.where(at_us - time_us[before] <= time_us[after] - at_us, before, after)
