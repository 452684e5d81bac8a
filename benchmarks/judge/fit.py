"""The fit of the judge: a conditional logit with L2, its temperature, and the file of its weights."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from advisor.gap.alternative import KINDS, Kind
from advisor.gap.judge import weights as weights_file
from advisor.gap.judge.logit import SCALES, Logit, shared_prior
from advisor.gap.judge.prior import FieldPrior
from benchmarks.judge.flights import JudgedFlight

Slot = tuple[Kind, str]
"""A weight: the kind of alternative that it belongs to, and its column."""
COLUMNS: Mapping[Kind, tuple[str, ...]] = {
    "none": ("file_gap", "file_distance", "misfit", "of_peak", "activity", "block_gain", "drift"),
    "parameters": ("file_gap", "file_distance", "gap_removed", "misfit", "block_gain"),
    "effect": (
        "tried", "screen_gain", "screen_share", "screen_lead", "file_agreement", "fit_gain", "fit_share",
        "heldout_gain", "heldout_sigmas", "support", "gap_removed", "change", "size_sigmas", "size",
        "at_bound", "model_gain", "model_share", "misfit", "block_share", "kinematics", "kinematic_size",
        "estimated", "drift", "step",
    ),
    "air": ("few_maneuvers", "shape", "activity", "block_explains"),
    "unknown": (
        "block_share", "block_left", "block_left_share", "block_explains", "law_gain", "law_lead", "misfit",
        "of_peak", "activity", "few_maneuvers", "drift", "step", "block_gain", "answer",
        "weight",
    ),
}  # fmt: skip
"""Columns that the judge weighs, by kind of alternative. Effects of the air share the weights of all effects,
and have some of their own."""
PRIOR_STD = 0.4
"""Prior standard deviation of a weight, nats per typical size of its column: no column alone decides. Factors
of two either way differ by less than one flight in thirty, on flights of a generator that was left out."""
_FREE = 0.1
"""Factor on the prior precision of an intercept, which the field prior corrects anyway."""
_TEMPERATURES = np.geomspace(0.5, 3.0, 25)
_SPREAD = 1e-6


@dataclass(frozen=True)
class _Table:
    """Flights as one matrix of alternatives."""

    X: np.ndarray
    """Shape (alternatives, weights)."""
    offset: np.ndarray
    """Shape (alternatives,): part of the utility that no weight changes."""
    right: np.ndarray
    first: np.ndarray
    """Index of the first alternative of each flight."""
    of: np.ndarray
    """Index of the flight of each alternative."""
    share: np.ndarray
    """Weight of each flight: every generator counts alike."""


def weighed(kind: Kind) -> list[Slot]:
    """Return the slots of the columns of a kind of alternative."""
    owners: tuple[Kind, ...] = ("effect", kind) if kind == "air" else (kind,)
    return [(owner, name) for owner in owners for name in COLUMNS[owner]]


def slots() -> list[Slot]:
    """Return owner and column of every weight; an empty column is the intercept of a kind."""
    every = dict.fromkeys(slot for kind in KINDS for slot in weighed(kind))
    return [*every, *((kind, "") for kind in KINDS if kind != "effect")]


def matrix(flight: JudgedFlight) -> np.ndarray:
    """Return the columns on the judge's scale, shape (alternatives, weights)."""
    places = {slot: k for k, slot in enumerate(slots())}
    X = np.zeros((len(flight.rows), len(places)))
    for n, row in enumerate(flight.rows):
        kind = row.alternative.kind
        for slot in weighed(kind):
            X[n, places[slot]] = SCALES[slot[1]](row.values.get(slot[1], 0.0))
        if (kind, "") in places:
            X[n, places[kind, ""]] = 1.0
    return X


def fitted(flights: Sequence[JudgedFlight]) -> Logit:
    """Return the judge of some flights, tempered by generators that each of its fits has not seen.

    A user's aircraft is none of the generators, so the temperature is that of a generator that was left out.
    """
    logit = _fitted(flights)
    utilities, offsets, right = [], [], []
    for generator in sorted({flight.generator for flight in flights}):
        other = _fitted([f for f in flights if f.generator != generator])
        for flight in (f for f in flights if f.generator == generator):
            offsets.append(shared_prior(flight.rows))
            utilities.append(other.utilities(flight.rows, other.flown) - offsets[-1])
            right.append(flight.is_right)
    return cooled(logit, _temperature(utilities, offsets, right))


def cooled(logit: Logit, temperature: float) -> Logit:
    """Return the judge with all utilities divided by a temperature."""
    weights = {
        kind: {name: w / temperature for name, w in its.items()} for kind, its in logit.weights.items()
    }
    return replace(
        logit, weights=weights, intercepts={kind: w / temperature for kind, w in logit.intercepts.items()}
    )


def _fitted(flights: Sequence[JudgedFlight]) -> Logit:
    table = _table(flights)
    spread = np.array([_std(column[column != 0.0]) for column in table.X.T])
    X, n = table.X / spread, len(table.X.T)
    penalty = np.full(n, 1.0 / (len(table.share) * PRIOR_STD**2))
    penalty[[not name for _, name in slots()]] *= _FREE

    def loss(w: np.ndarray) -> tuple[float, np.ndarray]:
        u = X @ w + table.offset
        e = np.exp(u - np.maximum.reduceat(u, table.first)[table.of])
        of_right = e * table.right
        every, good = (np.add.reduceat(part, table.first) for part in (e, of_right))
        good = np.maximum(good, 1e-300)
        gradient = X.T @ (table.share[table.of] * (of_right / good[table.of] - e / every[table.of]))
        value = -float(table.share @ np.log(good / every))
        return value + 0.5 * float(penalty @ w**2), penalty * w - gradient

    w = minimize(loss, np.zeros(n), jac=True, method="L-BFGS-B", options={"maxiter": 1000}).x / spread
    found = dict(zip(slots(), map(float, w), strict=True))
    return Logit(
        {kind: {slot[1]: found[slot] for slot in weighed(kind)} for kind in KINDS},
        {kind: found.get((kind, ""), 0.0) for kind in KINDS},
        flown_prior(flights),
    )


def flown_prior(flights: Sequence[JudgedFlight]) -> FieldPrior:
    """Return the shares of the right answers among flights, every generator counting alike."""
    share = _shares(flights)
    kinds = np.array([flight.kind for flight in flights])
    found = {kind: max(float(share[kinds == kind].sum()), 1e-3) for kind in FieldPrior.__slots__}
    return FieldPrior(**{kind: value / sum(found.values()) for kind, value in found.items()})


def _table(flights: Sequence[JudgedFlight]) -> _Table:
    # A flight whose truth no alternative states says nothing about the weights.
    kept = [flight for flight in flights if flight.is_right.any()]
    sizes = [len(flight.rows) for flight in kept]
    return _Table(
        np.vstack([matrix(flight) for flight in kept]),
        np.concatenate([shared_prior(flight.rows) for flight in kept]),
        np.concatenate([flight.is_right for flight in kept]),
        np.cumsum([0, *sizes[:-1]]),
        np.repeat(np.arange(len(kept)), sizes),
        _shares(kept),
    )


def _shares(flights: Sequence[JudgedFlight]) -> np.ndarray:
    generators = [flight.generator for flight in flights]
    return np.array([1.0 / generators.count(g) for g in generators]) / len(set(generators))


def _std(values: np.ndarray) -> float:
    return max(float(np.std(values)), float(np.mean(np.abs(values))), _SPREAD) if len(values) else 1.0


def _temperature(
    utilities: Sequence[np.ndarray], offsets: Sequence[np.ndarray], right: Sequence[np.ndarray]
) -> float:
    """Return the temperature with the largest likelihood on flights that a fit has not seen."""

    def loss(temperature: float) -> float:
        total = 0.0
        for u, offset, good in zip(utilities, offsets, right, strict=True):
            p = np.exp((u - np.max(u)) / temperature + offset)
            total -= float(np.log(max(p[good].sum() / p.sum(), 1e-9)))
        return total

    return float(min(_TEMPERATURES, key=loss))


def hash_of(flights: Sequence[JudgedFlight]) -> str:
    """Return a hash of the flights of a fit: of their names, evidence and truths."""
    lines = sorted(
        json.dumps([f.generator, f.case, f.truth, [sorted(r.values.items()) for r in f.rows]], default=str)
        for f in flights
    )
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def write_weights(logit: Logit, flights: Sequence[JudgedFlight]) -> None:
    """Write the module of the weights."""
    counts = {g: sum(f.generator == g for f in flights) for g in sorted({f.generator for f in flights})}
    of = ", ".join(f"{n} {g}" for g, n in counts.items())
    weights = {kind: {name: _rounded(w) for name, w in its.items()} for kind, its in logit.weights.items()}
    shares = ", ".join(f"{name}={_rounded(getattr(logit.flown, name))}" for name in FieldPrior.__slots__)
    text = f'''"""The weights of the judge, written by ``make judge``: do not edit them.

Fitted on {len(flights)} flights ({of}), hash {hash_of(flights)}.
"""

from advisor.gap.judge.logit import Logit
from advisor.gap.judge.prior import FieldPrior

LOGIT = Logit(
    weights={weights!r},
    intercepts={ {kind: _rounded(w) for kind, w in logit.intercepts.items()}!r},
    flown=FieldPrior({shares}),
)
'''
    Path(weights_file.__file__).write_text(text, encoding="utf-8")


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")
