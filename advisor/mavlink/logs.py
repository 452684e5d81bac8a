"""Opening a log of any kind: what it is, is read from its first bytes, not from its name."""

import stat
from collections.abc import Iterable, Iterator
from pathlib import Path

from advisor.flight.messages import Columns
from advisor.mavlink import ardupilot_log, dataflash, ulog
from advisor.mavlink.tlog import read_tlog
from advisor.problems import UnusableInputError


def open_log(
    path: Path, wanted: Iterable[str] | None = None, key: bytes | None = None
) -> Iterator[list[Columns]]:
    """Stream the messages of a ``.tlog``, an ArduPilot ``.bin`` or a PX4 ``.ulg``.

    The latter two hold the autopilot's own records; they come as the messages its telemetry
    would have carried, in one batch.

    Parameters
    ----------
    path : Path
    wanted : iterable of str, optional
        Names of the messages to give; all that are defined by default.
    key : bytes, optional
        Signing key of a tlog.

    Raises
    ------
    UnusableInputError
        When the file is missing, no file, empty or unreadable; while reading, when it holds
        no messages.
    """
    beginning = _beginning(path)
    if beginning.startswith(ulog.MAGIC):
        return ulog.read_ulog(path, wanted)
    if beginning.startswith(dataflash.HEADER):
        return ardupilot_log.read_dataflash(path, wanted)
    return read_tlog(path, wanted, key)


def _beginning(path: Path) -> bytes:
    """The first bytes of a file that can be read."""
    try:
        kind = path.stat().st_mode
        if stat.S_ISDIR(kind):
            raise UnusableInputError("not_a_file", f"{path} is a folder.", "Give the log file inside it.")
        if not stat.S_ISREG(kind):
            # A pipe may never speak, a device may never end.
            raise UnusableInputError(
                "not_a_file", f"{path} is a pipe or a device, no regular file.", "Give a log that is a file."
            )
        with path.open("rb") as file:
            beginning = file.read(16)
    except FileNotFoundError:
        raise UnusableInputError(
            "no_such_file", f"There is no file {path}.", "Check the name and the folder."
        ) from None
    except OSError as error:
        raise UnusableInputError(
            "unreadable", f"{path} cannot be read: {error.strerror}.", "Check its permissions."
        ) from None
    if not beginning:
        raise UnusableInputError(
            "empty", f"{path.name} is empty.", "Give a log that was recorded to its end."
        )
    return beginning
