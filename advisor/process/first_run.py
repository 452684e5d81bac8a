"""The first run on a machine: all numba kernels are compiled before the work, with a line of progress.

``python -m advisor.process.first_run`` compiles all kernels during an installation.
"""

import os
import platform
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from hashlib import sha256
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

Tell = Callable[[str], None]
Stages = Mapping[str, Callable[[], None]]
"""Function that compiles a kernel, by the kernel's name."""


def _called(module: str, function: str) -> Callable[[], None]:
    return lambda: getattr(import_module(module), function)()


KERNELS: Stages = {
    "log readers": _called("advisor.mavlink.logs.precompile", "warm_up"),
    "estimator": _called("advisor.oem.precompile", "warm"),
    "diagnosis": _called("advisor.gap.precompile", "warm_up"),
}


def compile_once(tell: Tell, stages: Stages = KERNELS) -> None:
    """Compile every kernel, unless this version was compiled on this machine before.

    A file in the folder of the machine code records the compilation. A kernel with changed source is compiled
    again at its next call, with this file or without.

    Parameters
    ----------
    stages
        Kernels to compile. Default: all kernels that commands call.
    """
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return
    folder = _folder()
    mark = folder and folder / f"inflight-advisor-{_key(stages)}.compiled"
    if mark is not None and mark.exists():
        return
    for number, (name, run) in enumerate(stages.items(), 1):
        tell(f"First run: compiling the {name} for this machine ({number} of {len(stages)}).")
        run()
    if mark is None:
        tell(
            "The compiled code cannot be kept, so every start compiles again. "
            "Set NUMBA_CACHE_DIR to a folder that you may write to."
        )
        return
    with suppress(OSError):
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()


def _folder() -> Path | None:
    """Return numba's folder for machine code, where compilation is recorded; None without one."""
    from platformdirs import user_cache_path

    given = os.environ.get("NUMBA_CACHE_DIR")
    beside = Path(__file__).parents[1] / "__pycache__"
    users = user_cache_path("inflight-advisor")
    choices = ([Path(given)] if given else []) + [beside, users]
    return next((folder for folder in choices if _writable(folder)), None)


def _writable(folder: Path) -> bool:
    """Return whether files can be written into a folder, or into its nearest existing parent."""
    nearest = next(path for path in (folder, *folder.parents) if path.exists())
    return nearest.is_dir() and os.access(nearest, os.W_OK)


def _key(stages: Stages) -> str:
    """Return a hash of the versions, the machine and the folder that determine the machine code."""
    parts = (version("numba"), _own_version(), sys.version, platform.machine(), __file__, *stages)
    return sha256("\0".join(parts).encode()).hexdigest()[:16]


def _own_version() -> str:
    from advisor import __version__

    return str(__version__)


if __name__ == "__main__":
    compile_once(lambda sentence: print(sentence, file=sys.stderr, flush=True))
