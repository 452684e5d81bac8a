"""Location of the bundled simulator and the sample flight: in the repository, or in an installed wheel."""

from pathlib import Path

_PACKAGE = Path(__file__).parents[1]
_INSTALLED = (_PACKAGE.parent / "inflight_sim").is_dir()

SIMULATOR = "inflight_sim" if _INSTALLED else "sim"
"""Name of the simulator's package. A wheel does not use the package name ``sim``, which other programs may
need."""
SAMPLES = _PACKAGE / "sample" if _INSTALLED else _PACKAGE.parent / "logs"
"""Folder with the sample flight."""
SAMPLE = "arduplane-calm"
"""Name of the sample flight's log and of its aircraft file, without their file endings."""
SLOW_SAMPLE = "arduplane-default-rates"
"""Name, without its ending, of the tutorial's first log, whose message streams are too slow."""
