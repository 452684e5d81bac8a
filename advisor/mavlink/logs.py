"""Opening a log of any kind: what it is, is read from its first bytes, not from its name."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from advisor.flight.messages import Columns
from advisor.mavlink import ardupilot_log, dataflash, ulog
from advisor.mavlink.frames import FrameScanner
from advisor.mavlink.tlog import scan_tlog
from advisor.problems import UnusableInputError


def open_log(
    path: Path,
    wanted: Iterable[str] | None = None,
    key: bytes | None = None,
    scanner: FrameScanner | None = None,
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
    scanner : FrameScanner, optional
        Reads a tlog in place of one made with ``wanted`` and ``key``; its statistics then tell of the log.

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
    return scan_tlog(path, scanner or FrameScanner(wanted, key))


def _beginning(path: Path) -> bytes:
    """The first bytes of a file that can be read."""
    if path.is_dir():
        raise UnusableInputError("not_a_file", f"{path} is a folder.", "Give the log file inside it.")
    try:
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
