"""Our row beside the published ones of an open benchmark of fixed-wing identification.

    python -m benchmarks.public FOLDER

FOLDER holds ``sportcub_train.npz`` and ``sportcub_validation.npz``, which have no licence to redistribute.
Only the first is fitted. Each segment of the second is simulated from its first measured state with its
commands. The error of a state is the root mean square over the range of the measurement, and the score is
the mean over states and segments.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from advisor.oem.estimate import NoEstimate
from benchmarks.public.flying import fitted, simulated
from benchmarks.public.segments import STATES, FloatArray, Segment, read_segments

PUBLISHED: Mapping[str, str] = {
    "output error": ".165",
    "subspace": ".213",
    "linear models": ".35 to .47",
    "nominal model": ".69",
    "filters": "1.75 to 1.99",
    "physics-informed network": "3.4",
    "sparse regression": "12",
}
"""Method to its published score on the same files."""


def errors(segment: Segment, found: FloatArray) -> FloatArray:
    """Return the root mean square error of each state over the range of its measurement, (13,)."""
    size = np.ptp(segment.states, axis=0)
    return np.asarray(
        np.sqrt(np.mean((found - segment.states) ** 2, axis=0)) / np.where(size > 0.0, size, 1.0)
    )


def rows(train: list[Segment], validation: list[Segment]) -> Iterator[str]:
    """Yield the table of methods, and the one of our segments."""
    flyer = fitted(train)
    yield "| method | score |"
    yield "|---|---|"
    if isinstance(flyer, NoEstimate):
        yield f"| **advisor** | no estimate: {flyer.text} |"
        return
    found = {segment.name: errors(segment, simulated(flyer, segment)) for segment in validation}
    yield f"| **advisor** | **{np.mean(list(found.values())):.3f}** |"
    yield from (f"| {method} | {score} |" for method, score in PUBLISHED.items())
    yield ""
    yield f"Not identifiable from the training segments: {', '.join(flyer.untold) or 'nothing'}."
    yield ""
    yield f"| segment | score | {' | '.join(STATES)} |"
    yield "|---" * (len(STATES) + 2) + "|"
    for name, each in found.items():
        yield f"| {name} | {np.mean(each):.3f} | {' | '.join(f'{e:.2f}' for e in each)} |"


def main() -> int:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    train, validation = (read_segments(folder / f"sportcub_{part}.npz") for part in ("train", "validation"))
    for row in rows(train, validation):
        print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
