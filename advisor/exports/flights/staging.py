"""A set of files that appears at once. All files are written under temporary names, then renamed."""

import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from advisor.words.problems import ConfigurationError


@contextmanager
def staged(folder: Path, inputs: Sequence[Path] = ()) -> Iterator[Path]:
    """Yield a temporary folder. Files written in the block are moved below ``folder`` when the block
    succeeds.

    Existing files of equal name are replaced. After any failure, everything below ``folder`` is unchanged.

    Parameters
    ----------
    folder
        Folder for the files, which is created if missing.

    Raises
    ------
    ConfigurationError
        The folder cannot be created or written to, or a file would replace an input.
    """
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=".export-", dir=folder))
    except OSError as error:
        raise _refused(folder, error) from None
    done = False
    try:
        yield stage
        _publish(stage, folder, inputs)
        done = True
    except OSError as error:
        raise _refused(folder, error) from None
    finally:
        shutil.rmtree(stage, ignore_errors=True)
        if not done:
            with suppress(OSError):  # somebody else may have put a file there meanwhile
                for empty in made:
                    empty.rmdir()


def _publish(stage: Path, folder: Path, inputs: Sequence[Path]) -> None:
    """Write all files to the disk, then rename each."""
    files = sorted(path for path in stage.rglob("*") if path.is_file())
    targets = [folder / path.relative_to(stage) for path in files]
    refuse_inputs(targets, inputs)
    for path in files:
        with path.open("rb") as file:
            os.fsync(file.fileno())
    for path, target in zip(files, targets, strict=True):
        target.parent.mkdir(exist_ok=True)
        path.replace(target)


def refuse_inputs(targets: Sequence[Path], inputs: Sequence[Path]) -> None:
    """Refuse to overwrite an input file.

    Raises
    ------
    ConfigurationError
        A target is one of the inputs.
    """
    read = {path.resolve() for path in inputs}
    for target in targets:
        if target.resolve() in read:
            raise ConfigurationError(f"-o: {target} is an input of this command; name another place.")


def _refused(folder: Path, error: OSError) -> ConfigurationError:
    reason = error.strerror or str(error)
    return ConfigurationError(
        f"-o: {folder} cannot be written to: {reason}. Make room or name another place."
    )
