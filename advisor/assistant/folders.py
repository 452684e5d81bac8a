"""Files that an assistant may read: those inside the folders of the command line, up to a given size."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from advisor.mavlink.logs.formats import ENDINGS

LOGS = (*ENDINGS, ".zip", ".gz", ".log", ".raw")
"""Endings of the files that are listed as logs."""


class RefusedError(Exception):
    """A file that the assistant may not read. The exception's message is for the assistant."""


@dataclass(frozen=True, slots=True)
class Folders:
    """Folders that an assistant may read."""

    roots: tuple[Path, ...]
    """Paths of the folders with links resolved."""
    most_bytes: int
    """Size of the largest file that an assistant may read, bytes."""

    def file(self, name: str) -> Path:
        """Return a file inside the folders, with links resolved.

        Parameters
        ----------
        name
            Absolute path, or path relative to one of the folders.

        Raises
        ------
        RefusedError
            The path leaves the folders, names no file, or the file is too large.
        """
        if not name.strip():
            raise RefusedError(
                "The name of the file is empty: give a path inside the folders of this server."
            )
        if "\0" in name:
            raise RefusedError("The name of the file holds a zero byte, which no path may hold.")
        try:
            return self._file(name)
        except (OSError, RuntimeError) as error:  # a name too long, a folder that may not be read, a loop
            why = error.strerror if isinstance(error, OSError) else "its links lead in a circle"
            raise RefusedError(f"{name[:100]} cannot be read: {why}.") from None

    def _file(self, name: str) -> Path:
        candidates = [(root / name).resolve() for root in self.roots]
        inside = [path for path in candidates if any(path.is_relative_to(root) for root in self.roots)]
        if not inside:
            raise RefusedError(f"{name} lies outside the folders of this server: {self.listed}.")
        file = next((path for path in inside if path.is_file()), None)
        if file is None:
            other = next((path for path in inside if path.exists()), None)
            if other is None:
                raise RefusedError(f"There is no file {name} in {self.listed}.")
            kind = "a folder: name a log in it" if other.is_dir() else "a pipe, socket or device, not a file"
            raise RefusedError(f"{name} is {kind}.")
        size = file.stat().st_size
        if size > self.most_bytes:
            most = _amount(self.most_bytes)
            raise RefusedError(f"{name} has {_amount(size)}, and this server reads at most {most}.")
        return file

    @property
    def listed(self) -> str:
        return ", ".join(map(str, self.roots))

    def logs(self) -> Iterator[Path]:
        """Yield the files in the folders that look like logs, in the order of their names."""
        for root in self.roots:
            files = (path for path in root.rglob("*") if path.suffix.lower() in LOGS and path.is_file())
            yield from sorted(path for path in files if path.resolve().is_relative_to(root))


def _amount(count: int) -> str:
    """Return a number of bytes in words, in the largest suitable unit."""
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= size:
            return f"{count / size:.{0 if count >= 10.0 * size else 1}f} {unit}".replace(".0 ", " ")
    return f"{count} bytes"


def folders_of(roots: Sequence[Path], most_bytes: int) -> Folders:
    """Return the folders of a command line, with links resolved."""
    return Folders(tuple(root.resolve() for root in roots), most_bytes)
