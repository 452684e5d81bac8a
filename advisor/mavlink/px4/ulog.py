"""PX4's own log (``.ulg``), read by pyulog."""

import contextlib
import io
import struct
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from advisor.flight.signals.messages import Columns
from advisor.mavlink.px4 import px4_vehicle
from advisor.mavlink.px4.px4_air import air
from advisor.mavlink.px4.px4_motion import motion
from advisor.mavlink.px4.px4_outputs import outputs
from advisor.mavlink.px4.px4_topics import TOPICS, TimedMessages, Topics, topics_of
from advisor.mavlink.px4.px4_vehicle import unix_time_base_s
from advisor.mavlink.records.equivalent import message, system_id
from advisor.words.mends import mends_of, sentence
from advisor.words.problems import UnusableInputError

MAGIC = b"ULog\x01\x12\x35"


class WholeFile(io.BufferedReader):
    """A file in which a read beyond the end fails, unless nothing is left.

    Where damaged definitions lead pyulog 1.3 beyond the end, pyulog steps back by the bytes it wanted to
    read, not by those it got. It would never arrive.
    """

    def read(self, size: int | None = -1, /) -> bytes:
        """Return exactly ``size`` bytes, or none at the end."""
        data = super().read(size)
        if size is not None and 0 < len(data) < size:
            raise struct.error
        return data


def read_ulog(path: Path, wanted: Iterable[str] | None = None, starts_at: int = 0) -> Iterator[list[Columns]]:
    """Yield the messages of a ``.ulg``, in one batch, ordered by time.

    Parameters
    ----------
    path
    wanted
        Names of the messages to return. Default: all.
    starts_at
        Bytes before the log.

    Raises
    ------
    UnusableInputError
        The file holds neither attitude, sensors, nor outputs.
    """
    from pyulog import ULog  # here, for no other command needs to wait for its import

    try:
        # pyulog prints its warnings; standard output belongs to the result.
        raw = io.FileIO(path) if starts_at == 0 else io.BytesIO(path.read_bytes()[starts_at:])
        with WholeFile(raw) as file, contextlib.redirect_stdout(sys.stderr):
            log = ULog(file, list(TOPICS))
    except Exception as error:  # whatever pyulog meets in damaged bytes
        raise _nothing_in(path) from error
    with np.errstate(over="ignore", invalid="ignore"):  # damaged records hold any number
        columns = _columns(log)
    if not {c.name for c in columns} & {"ATTITUDE", "HIGHRES_IMU", "SERVO_OUTPUT_RAW"}:
        raise _nothing_in(path)
    names = None if wanted is None else set(wanted)
    yield [c for c in columns if names is None or c.name in names]


def _nothing_in(path: Path) -> UnusableInputError:
    return UnusableInputError(
        "no_messages",
        f"{path.name} holds no attitude, sensor or actuator topics of PX4.",
        f"{sentence(mends_of('px4', 'ulog').present(['ATTITUDE', 'RAW_IMU', 'SERVO_OUTPUT_RAW']), '')}, "
        "or give a .tlog.",
    )


def _columns(log: Any) -> list[Columns]:
    """Return every message from the topics, numbered by time."""
    topics = topics_of(log)
    messages = translate(log, topics)
    time_us = np.concatenate([m.time_us for m in messages])
    order = np.empty(len(time_us), dtype=np.int64)
    order[np.argsort(time_us, kind="stable")] = np.arange(len(time_us))
    orders = np.split(order, np.cumsum([len(m.time_us) for m in messages])[:-1])
    base_s = unix_time_base_s(topics)
    system = system_id(log.initial_parameters.get("MAV_SYS_ID"))
    return [
        message(m.name, system, numbers, base_s + m.time_us.astype(np.float64) * 1e-6, m.fields, "ulog")
        for m, numbers in zip(messages, orders, strict=True)
        if len(numbers)
    ]


def translate(log: Any, topics: Topics) -> list[TimedMessages]:
    """Return every message from a `pyulog.ULog` and its topics."""
    parameters = px4_vehicle.parameters_of(log)
    breathed, said = air(topics)
    moved = outputs(topics, parameters)
    messages = [
        *motion(topics, bool(parameters.get("SENS_BOARD_ROT"))),
        *breathed,
        *px4_vehicle.named_values(topics),
        *px4_vehicle.receiver(topics),
        *moved.messages,
        *px4_vehicle.texts(log),
    ]
    start_us = min((int(np.min(m.time_us)) for m in messages), default=0)
    return [
        px4_vehicle.heartbeat(topics, parameters, start_us),
        *px4_vehicle.vtol_states(topics),
        *px4_vehicle.version(log, start_us),
        *px4_vehicle.stated(log, moved.found, start_us),
        *px4_vehicle.remarks([*said, *moved.said, *px4_vehicle.dropouts(log)], start_us),
        *messages,
    ]
