"""Our rows next to the published ones of an open benchmark of fixed-wing identification.

    python -m benchmarks.public FOLDER

FOLDER holds ``sportcub_train.npz`` and ``sportcub_validation.npz``, which have no licence to redistribute.
Only the first is fitted, except for bounds that are marked as no scores. Each segment of the second is
simulated from its first measured state with its commands. The error of a state is the root mean square over
the range of the measurement, and the score is the mean over states and segments. The score does not depend
on the direction of an axis.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from advisor.oem.estimate import NoEstimate
from advisor.process.arrays import FloatArray
from benchmarks.public.advised import advised, coefficients_of, lagged
from benchmarks.public.linear import TRIMS, simulated
from benchmarks.public.segments import STATES, Segment, read_segments, upright
from benchmarks.public.whole import by_output_error, regressed

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


def errors_of(
    coefficients: FloatArray, segments: Sequence[Segment], lags_s: Mapping[str, float] | None = None
) -> FloatArray:
    """Return the errors (segments, 13) of a model (6, 11), with lags of the servos, s."""
    moved = [lagged(segment, lags_s or {}) for segment in segments]
    return np.array([errors(s, simulated(coefficients[None], s)[0]) for s in moved])


def rows(train: Sequence[Segment], validation: Sequence[Segment]) -> Iterator[str]:
    """Yield the table of methods, the shares of the forces, the errors of each segment, and the bounds."""
    named = regressed(train)[1]
    train, validation = list(map(upright, train)), list(map(upright, validation))
    begun, shares = regressed(train)
    fitted = by_output_error(train, begun)
    yield "| method | score | on training |"
    yield "|---|---|---|"
    yield _own(train, validation, begun)
    for name, model in (("regression, both axes", begun), ("**output error, both axes**", fitted)):
        yield f"| {name} | {_mean(errors_of(model, validation))} | {_mean(errors_of(model, train))} |"
    yield from (f"| {method} | {score} | |" for method, score in PUBLISHED.items())
    yield ""
    yield "| share that the regression explains | axes as named | upright |"
    yield "|---|---|---|"
    yield from (f"| {name} | {named[name]:.2f} | {share:.2f} |" for name, share in shares.items())
    yield ""
    yield f"| output error, both axes | score | {' | '.join(STATES)} |"
    yield "|---" * (len(STATES) + 2) + "|"
    for segment, each in zip(validation, errors_of(fitted, validation), strict=True):
        yield f"| {segment.name} | {_mean(each)} | {' | '.join(f'{e:.2f}' for e in each)} |"
    yield ""
    yield from bounds(fitted, validation)


def bounds(fitted: FloatArray, validation: Sequence[Segment]) -> Iterator[str]:
    """Yield errors of models that have seen the validation: no scores, but what such models can reach."""
    one = by_output_error(validation, fitted)
    trimmed = [errors_of(by_output_error([each], fitted, TRIMS), [each]) for each in validation]
    yield "| no score: fitted to the validation itself | error |"
    yield "|---|---|"
    yield f"| one linear model | {_mean(errors_of(one, validation))} |"
    yield f"| the model of the training, six trims for each segment | {_mean(np.array(trimmed))} |"


def _own(train: Sequence[Segment], validation: Sequence[Segment], begun: FloatArray) -> str:
    found = advised(train)
    if isinstance(found, NoEstimate):
        return f"| advisor, each axis | no estimate: {found.text} | |"
    own = coefficients_of(found, begun)
    scores = " | ".join(_mean(errors_of(own, part, found.lags_s)) for part in (validation, train))
    untold = f" ({', '.join(found.untold)} untold)" if found.untold else ""
    return f"| advisor, each axis{untold} | {scores} |"


def _mean(each: FloatArray) -> str:
    return f"{np.mean(each):.3f}"


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    train, validation = (read_segments(folder / f"sportcub_{part}.npz") for part in ("train", "validation"))
    for row in rows(train, validation):
        print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
