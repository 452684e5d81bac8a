"""Rewrites a DataFlash log record by record: other names, other stamps, records left out or added."""

import struct
from collections.abc import Callable, Collection, Mapping

from tests.mavlink.autopilot_logs import FORMATS

Definitions = Mapping[str, tuple[str, str, Callable[[float], Mapping[str, float]] | None]]
"""Record name to format, columns, and the values of some columns by the time in s."""
_SIZES = {"B": 1, "M": 1, "h": 2, "H": 2, "c": 2, "C": 2, "i": 4, "I": 4, "f": 4, "e": 4, "L": 4, "n": 4}
_SIZES |= {"Q": 8, "N": 16, "Z": 64}
_PACK = {"B": "B", "M": "B", "Q": "Q", "I": "I", "f": "f", "N": "16s"}
HEALTH_AT = {"IMU": 37, "ARSP": 20}
"""Where GH of IMU and H of ARSP lie behind the stamp."""
_HEAD = b"\xa3\x95"


def _definition(number: int, name: str, form: str, columns: str) -> bytes:
    length = 3 + sum(_SIZES[character] for character in form)
    body = struct.pack("<BB4s16s64s", number, length, name.encode(), form.encode(), columns.encode())
    return _HEAD + b"\x80" + body


def records_of(log: bytes) -> list[tuple[str, bytes]]:
    by_number = {number: name for name, (number, _, _) in FORMATS.items()}
    lengths = {
        number: 3 + sum(_SIZES[character] for character in form) for number, form, _ in FORMATS.values()
    }
    found, at = [], 0
    while at < len(log):
        number = log[at + 2]
        found.append((by_number[number], log[at : at + lengths[number]]))
        at += lengths[number]
    return found


def rewritten(
    log: bytes,
    renamed: Mapping[str, Mapping[str, str]] | None = None,
    milliseconds: bool = False,
    without: Mapping[str, str] | None = None,
    later_us: int = 0,
    drop: Collection[str] = (),
    every: Mapping[str, int] | None = None,
    add: Definitions | None = None,
    per_att: int = 1,
    good_imu_apart: bool = False,
    unhealthy: Mapping[str, tuple[float, float]] | None = None,
) -> bytes:
    """The log of the builders, changed.

    Parameters
    ----------
    renamed
        Record to its columns' other names.
    milliseconds
        Stamps become TimeMS, 32 bit; of GPS T at the end, as in 2014.
    without
        Record to the column that it loses; only a first one.
    later_us
        Added to every stamp.
    drop, every
        Records left out altogether, and all but every n-th.
    add, per_att
        Further records, so many in each ATT record's time of 0.04 s.
    good_imu_apart
        Records of sensor 0 become IMU2, without a number, and those of sensor 1, which stands still, IMU.
    unhealthy
        ``IMU`` or ``ARSP`` and when its sensors are stated to be unhealthy, s.
    """
    out, counted = [], dict.fromkeys(FORMATS, 0)
    layouts = {name: (form, columns) for name, (_, form, columns) in FORMATS.items()}
    changed: dict[str, tuple[str, str]] = {}
    for name, (form, columns) in layouts.items():
        columns = ",".join((renamed or {}).get(name, {}).get(c, c) for c in columns.split(","))
        if (without or {}).get(name):
            form, columns = form[1:], columns.partition(",")[2]
        elif milliseconds and name == "GPS":
            form, columns = form[1:] + "I", columns.partition(",")[2].replace("GMS", "TimeMS") + ",T"
        elif milliseconds and columns.startswith("TimeUS"):
            form, columns = "I" + form[1:], columns.replace("TimeUS", "TimeMS")
        changed[name] = form, columns
    apart = ("Qffffff", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ")
    dropped = {"FMT", "IMU"} if good_imu_apart else {"FMT"}
    out += [_definition(FORMATS[name][0], name, *changed[name]) for name in changed if name not in dropped]
    out += [_definition(40, "IMU2", *apart), _definition(41, "IMU", *apart)] if good_imu_apart else []
    for k, (name, (form, columns, _)) in enumerate((add or {}).items()):
        out.append(_definition(50 + k, name, form, columns))
    for name, record in records_of(log):
        counted[name] += 1
        if name == "FMT" or name in drop or counted[name] % (every or {}).get(name, 1):
            continue
        stamp = struct.unpack_from("<Q", record, 3)[0] + later_us
        fields = record[11:]
        start_s, end_s = (unhealthy or {}).get(name, (0.0, 0.0))
        if start_s <= stamp * 1e-6 < end_s:
            at = HEALTH_AT[name]
            fields = fields[:at] + b"\0" + fields[at + 1 :]
        if good_imu_apart and name == "IMU":
            out.append(_HEAD + bytes([40 + fields[0]]) + struct.pack("<Q", stamp) + fields[1:25])
            continue
        head, tail = struct.pack("<Q", stamp), b""
        if (without or {}).get(name):
            head = b""
        elif milliseconds and name == "GPS":
            head, tail = b"", struct.pack("<I", stamp // 1000)
        elif milliseconds:
            head = struct.pack("<I", stamp // 1000)
        out.append(record[:3] + head + fields + tail)
        for k, (form, columns, values) in enumerate((add or {}).values()):
            for j in range(per_att if name == "ATT" else 0):
                at_us = stamp + 40_000 * j // per_att
                given = {"TimeUS": at_us, **(values(at_us * 1e-6) if values else {})}
                body = b"".join(
                    struct.pack("<" + _PACK[c], given.get(column, 0))
                    for c, column in zip(form, columns.split(","), strict=True)
                )
                out.append(_HEAD + bytes([50 + k]) + body)
    return b"".join(out)
