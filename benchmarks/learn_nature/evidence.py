"""Evidence of a flight's explanations, kept so that other natural widths weigh it again at once.

The diagnosis runs as in ``advisor gap``. An observer takes the rows of its first posterior, with the residual
of each model and with the evidence of each natural effect at other natural sizes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Self
from unittest.mock import patch

import numpy as np

from advisor.gap.inference import engine
from advisor.gap.inference.evidence import evidence_of
from advisor.gap.inference.explanation import Row
from advisor.gap.inference.pitch import PitchModel
from advisor.gap.inference.posterior import NONE, PARAMETERS
from advisor.gap.inference.residual import NATURAL, Residual, residual_of
from advisor.gap.inference.sizes import natural_shares

GRID = (0.25, 0.5, 1.0, 2.0, 4.0, 10.0)
"""Factors on the natural size of effects at which the evidence is kept."""
SHEETS = {"q": float(np.radians(0.2)), "a_z": 0.2, "theta": float(np.radians(0.3)), "alpha": 0.0}
"""Errors by data sheets: MEMS gyro .2 deg/s, accelerometer .2 m/s², attitude .3 deg. The angle of attack has
none in common."""
_EXACT = 1e-6
"""Numerical: difference, nats, below which a term counts as the density of a right model."""


@dataclass(frozen=True)
class KeptRow:
    """One row of the posterior."""

    name: str
    """Name of the row's alternative."""
    nats: float
    """Log weight without the density of the residual, nats."""
    size: float
    """Size of the residual (``Residual.size``)."""
    sheet_size: float
    """Size of the residual where data sheets state the natural error of each channel."""
    lacks: bool
    """Whether the row takes its model as one that lacks a law."""
    natural: tuple[float, ...] = ()
    """Change of the log weight, nats, at each factor of ``GRID``; empty without a natural effect."""


@dataclass(frozen=True)
class KeptFlight:
    """Evidence of one flight with its truth."""

    generator: str
    case: str
    kind: str
    """Kind of the truth: none, parameters, one, two, outside."""
    right: tuple[str, ...]
    """Names of alternatives that are right."""
    rows: tuple[KeptRow, ...]

    def document(self) -> dict[str, Any]:
        """Return the flight as plain numbers and texts."""
        return asdict(self)

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> Self:
        """Return the flight from its document."""
        rows = tuple(KeptRow(**{**row, "natural": tuple(row["natural"])}) for row in document["rows"])
        return cls(**{**document, "right": tuple(document["right"]), "rows": rows})


@dataclass
class Observer:
    """Rows of the first posterior of a diagnosis, with the residuals of its models."""

    rows: tuple[KeptRow, ...] = ()
    heat: float = 1.0
    residuals: dict[int, tuple[Residual, float]] = field(default_factory=dict)
    """Residual of a model and its size by data sheets, by the identity of the model."""

    def take(self, rows: Sequence[Row[Any]]) -> None:
        """Keep the rows of the first posterior."""
        if not self.rows:
            self.rows = tuple(self._kept(row) for row in rows)

    def _kept(self, row: Row[Any]) -> KeptRow:
        size, residual, sheet, lacks = self._as_weighed(row)
        sheet_size = size * sheet / max(residual.size, 1e-12)
        nats = row.weight - Residual(size, {}).nats(False)[lacks]
        return KeptRow(row.alternative.name, nats, size, sheet_size, lacks, self._natural(row, lacks))

    def _as_weighed(self, row: Row[Any]) -> tuple[float, Residual, float, bool]:
        """Return the size of the residual in a row's weight, the residual, its size by data sheets, and
        whether the row takes its model as one that lacks a law.

        Models of one alternative share the residual of the likeliest, so a row may have another model's.
        """
        own = self.residuals.get(id(row.model))
        every = [*([own] if own is not None else []), *self.residuals.values()]
        sized = [(r.beside_air if row.in_moving_air else r.size, r, sheet) for r, sheet in every]
        for lacks in (False, True):
            for size, residual, sheet in sized:
                if abs(row.terms["residual"] - Residual(size, {}).nats(False)[lacks]) < _EXACT:
                    return size, residual, sheet, lacks
        # A disturbance that every model may have is lacking with a share of the density.
        return (*sized[0], True)

    def _natural(self, row: Row[Any], lacks: bool) -> tuple[float, ...]:
        """Return the change of evidence of a natural effect at other natural sizes."""
        model = row.explanation
        if row.pair is not None or row.alternative not in (NONE, PARAMETERS) or lacks:
            return ()
        if not isinstance(model, PitchModel) or model.variant is None:
            return ()
        shares = natural_shares(model.variant)
        at = (np.where(shares < 1.0, np.minimum(shares * factor, 1.0), 1.0) for factor in GRID)
        evidence = [evidence_of(model.problem, model.fitted, self.heat, each) for each in at]
        nats = [one.right if row.alternative == NONE else one.wrong for one in evidence]
        return tuple(float(one - nats[GRID.index(1.0)]) for one in nats)


class _Watched:
    """A flight of the inference, whose residuals an observer sees."""

    def __init__(self, flight: Any, observer: Observer) -> None:
        self._flight, self._observer = flight, observer

    def __getattr__(self, name: str) -> Any:
        return getattr(self._flight, name)

    def residual(self, model: Any, heat: float) -> Residual:
        """Return the residual of a model, which the observer keeps."""
        residual: Residual = self._flight.residual(model, heat)
        sheet = residual.size
        if isinstance(model, PitchModel):
            sheet = residual_of(_by_data_sheets(self._flight.problem), model.fitted, heat).size
        self._observer.residuals[id(model)] = residual, sheet
        return residual


def _by_data_sheets(problem: Any) -> Any:
    """Return the problem with peaks so large that each channel's natural share includes its data sheet."""
    flights = problem.flights
    sheets = np.array([SHEETS.get(name, 0.0) for name in flights.channels])
    return replace(problem, flights=replace(flights, peaks=np.hypot(flights.peaks, sheets / NATURAL)))


@contextmanager
def observed() -> Iterator[Observer]:
    """Observe the diagnosis that runs in the context."""
    observer, rows_of, posterior_of = Observer(), engine.rows_of, engine.posterior_of

    def watched_rows(flight: Any, stage: Any, *more: Any) -> Any:
        if observer.rows:
            return rows_of(flight, stage, *more)
        observer.heat = stage.heat
        return rows_of(_Watched(flight, observer), stage, *more)

    def watched_posterior(rows: Any) -> Any:
        listed = list(rows)
        observer.take(listed)
        return posterior_of(listed)

    with (
        patch.object(engine, "rows_of", watched_rows),
        patch.object(engine, "posterior_of", watched_posterior),
    ):
        yield observer


Diagnose = Callable[[], object]


def evidence_rows(diagnose: Diagnose) -> tuple[KeptRow, ...]:
    """Run a diagnosis and return its kept rows; empty for a diagnosis without a posterior."""
    with observed() as observer:
        diagnose()
    return observer.rows
