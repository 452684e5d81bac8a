"""Table 1 of this study next to the paper's: medians, spread, and the paper's rank among the campaigns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Rule
from advisor.aircraft.reference import PARAMETERS
from advisor.bundled.study.campaigns import TABLE_1, PaperRow, RuleOutcome
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Row:
    """Outcomes of all campaigns of one rule at one noise level."""

    rule: Rule
    noise_percent: float
    needed: tuple[int | None, ...]
    """Number of manoeuvres until the stop of each campaign. None: the campaign never stopped."""
    error_percent: FloatArray
    """(campaigns, 8) |error| at the stop, or at the end, in percent of the true value."""
    outside_tolerance_percent: FloatArray | None
    """(8,) fraction of stops with the parameter outside its tolerance, %, for ``information`` only."""

    @property
    def paper(self) -> PaperRow | None:
        """Row of the paper's Table 1, for the paper's rules."""
        return TABLE_1.get((self.rule, self.noise_percent))

    @property
    def never_percent(self) -> float:
        """Percentage of campaigns that did not stop."""
        return 100.0 * float(np.mean([n is None for n in self.needed]))

    def needed_quantile(self, share: float) -> int | None:
        """Return the number of manoeuvres that stopped ``share`` of the campaigns; None for fewer stops."""
        order = sorted(np.inf if n is None else n for n in self.needed)
        value = order[max(0, int(np.ceil(share * len(order))) - 1)]
        return None if np.isinf(value) else int(value)

    def needed_percentile_of_paper(self) -> float | None:
        """Return the share of our campaigns that stopped no later than the paper's."""
        if self.paper is None:
            return None
        limit = np.inf if self.paper.needed is None else self.paper.needed
        return 100.0 * float(np.mean([(np.inf if n is None else n) <= limit for n in self.needed]))

    def percentile_of_paper(self) -> Mapping[str, float]:
        """Return the share of our campaigns with a smaller error than the paper's, per parameter."""
        if self.paper is None:
            return {}
        return {
            name: 100.0 * float(np.mean(self.error_percent[:, k] < self.paper.error_percent[name]))
            for k, name in enumerate(PARAMETERS)
        }


def row(rule: Rule, noise_percent: float, outcomes: Sequence[RuleOutcome], truth: FloatArray) -> Row:
    """Return the outcomes of one rule at one noise level as a row."""
    errors = np.array([o.theta for o in outcomes]) - truth
    outside = None
    if rule == "information":
        stopped = [k for k, o in enumerate(outcomes) if o.needed is not None]
        tolerance = np.array([outcomes[k].tolerance for k in stopped])
        outside = 100.0 * np.mean(np.abs(errors[stopped]) > tolerance, axis=0) if stopped else None
    return Row(
        rule, noise_percent, tuple(o.needed for o in outcomes), 100.0 * np.abs(errors / truth), outside
    )


def as_document(rows: Sequence[Row], campaigns: int) -> dict[str, object]:
    """Return the rows as ``advisor.study/1``."""
    return {"schema": "advisor.study/1", "campaigns": campaigns, "rows": [_entry(r) for r in rows]}


def _entry(row: Row) -> dict[str, object]:
    quantiles = np.quantile(row.error_percent, [0.1, 0.5, 0.9], axis=0)
    entry: dict[str, object] = {
        "rule": row.rule,
        "noise_percent": row.noise_percent,
        "needed": {
            "median": row.needed_quantile(0.5),
            "p90": row.needed_quantile(0.9),
            "never_percent": row.never_percent,
        },
        "error_percent": {
            name: dict(zip(("p10", "median", "p90"), map(float, quantiles[:, k]), strict=True))
            for k, name in enumerate(PARAMETERS)
        },
    }
    if row.paper is not None:
        entry["paper"] = {
            "needed": row.paper.needed,
            "needed_percentile": row.needed_percentile_of_paper(),
            "error_percent": dict(row.paper.error_percent),
            "percentile_of_paper": dict(row.percentile_of_paper()),
        }
    if row.outside_tolerance_percent is not None:
        entry["outside_tolerance_percent"] = {
            name: float(row.outside_tolerance_percent[k]) for k, name in enumerate(PARAMETERS)
        }
    return entry
