"""What the advisor makes of a log with inputs of three surfaces at once, against the truth."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import CampaignState, JudgedManeuver
from advisor.mavlink.logs.logs import read_whole_log
from advisor.model.axes.lateral import LATERAL, natural_size
from advisor.oem.estimate import Estimate
from advisor.words.quantities import NORMAL_95

TOLERANCE = 0.10
"""Tolerance of a derivative, as a share of it: twice the advisor's usual tolerance of the response."""
SMALL = 0.25
"""Share of a derivative's natural size below which its tolerance stays that of this share. Such a derivative
hardly moves the aircraft."""
Truth = Callable[[float], Mapping[str, float]]
"""Derivatives of both axes at a true air speed, m/s."""


@dataclass(frozen=True)
class Row:
    """One derivative: estimate, half of its 95 % interval, truth and tolerance."""

    name: str
    value: float
    half: float
    truth: float
    tolerance: float

    @property
    def holds(self) -> bool:
        """Whether the interval holds the truth."""
        return abs(self.value - self.truth) <= self.half

    @property
    def near(self) -> bool:
        """Whether the estimate lies within the tolerance."""
        return abs(self.value - self.truth) <= self.tolerance


@dataclass(frozen=True)
class Score:
    """Derivatives of one flight, and how many of the asked ones the advisor gives."""

    rows: tuple[Row, ...]
    asked: int
    accepted: tuple[int, int]
    """Number of accepted stretches in pitch, and in roll and yaw."""


def score(log: Path, aircraft: Aircraft, truth: Truth, by_ground_speed: bool = False) -> Score:
    """Print what the advisor makes of a log, and return it.

    Parameters
    ----------
    by_ground_speed
        Whether the truth holds at the log's mean ground speed, which is the true air speed without wind; else
        at the estimate's air speed.
    """
    campaign = Campaign(aircraft, lateral=True)
    for columns in read_whole_log(log):
        campaign.feed(columns)
    campaign.finish()
    state = campaign.state
    sideways = state.lateral.maneuvers if state.lateral is not None else ()
    print(f"\n{log.name}: {_counted(state.maneuvers)} in pitch, {_counted(sideways)} in roll and yaw")
    print("\n| derivative | estimate | truth | off | within tolerance | inside |\n|---|---|---|---|---|---|")
    rows = tuple(_rows(state, truth, log if by_ground_speed else None))
    for row in rows:
        off = f"{100.0 * (row.value / row.truth - 1.0):+.1f} %" if row.truth else "–"
        near, holds = ("yes" if good else "**no**" for good in (row.near, row.holds))
        print(
            f"| {row.name} | {row.value:.3g} ± {row.half:.2g} | {row.truth:.3g} | {off} | {near} | {holds} |"
        )
    for axis, one in state.axes.items():
        at = one.flight_test.stopped_at
        print(f"{axis}: {f'TEST COMPLETE after stretch {at}' if at else 'the test goes on'}")
        refused = [judged.verdict.sentence for judged in one.maneuvers if not judged.verdict.accepted]
        print("".join(f"{axis} refused: {sentence}\n" for sentence in refused), end="", flush=True)
    return Score(rows, len(_ASKED), (_accepted(state.maneuvers), _accepted(sideways)))


_ASKED = ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e", *LATERAL.names.shared)


def totals(scores: Sequence[Score]) -> str:
    """Return the line of totals over several flights."""
    rows = [row for one in scores for row in one.rows]
    asked = sum(one.asked for one in scores)
    near, holds = sum(row.near for row in rows), sum(row.holds for row in rows)
    return (
        f"\n{near} of {asked} derivatives within tolerance ({100.0 * near / asked:.0f} %); "
        f"{holds} of {len(rows)} intervals hold ({100.0 * holds / max(len(rows), 1):.0f} %)."
    )


def _accepted(maneuvers: Sequence[JudgedManeuver]) -> int:
    return sum(one.verdict.accepted for one in maneuvers)


def _counted(maneuvers: Sequence[JudgedManeuver]) -> str:
    return f"{_accepted(maneuvers)} of {len(maneuvers)} tests accepted"


def _rows(state: CampaignState, truth: Truth, log: Path | None) -> Iterator[Row]:
    side = state.lateral
    axes = ((state.model, state.maneuvers), (side.model, side.maneuvers) if side is not None else (None, ()))
    for model, maneuvers in axes:
        if model is not None and model.airspeed_m_s is not None:
            speed = model.airspeed_m_s if log is None else _true_speed(log, maneuvers)
            yield from _compared(model, truth(speed))


def _true_speed(log: Path, maneuvers: Sequence[JudgedManeuver]) -> float:
    """Return the mean speed over the accepted manoeuvres, m/s, from the velocity over the ground."""
    speeds: list[float] = []
    for columns in (one for several in read_whole_log(log) for one in several):
        if columns.name != "GLOBAL_POSITION_INT":
            continue
        t = columns.fields["time_boot_ms"] * 1e-3
        v = 0.01 * np.sqrt(sum(columns.fields[name].astype(float) ** 2 for name in ("vx", "vy", "vz")))
        for span in (one.maneuver.span for one in maneuvers if one.verdict.accepted):
            speeds += v[(t >= span.record_from_s) & (t <= span.end_s)].tolist()
    if not np.any(speeds):
        raise SystemExit(f"{log.name} has no velocity over the ground: give a tlog with GLOBAL_POSITION_INT.")
    return float(np.mean(speeds))


def _compared(model: Estimate, truth: Mapping[str, float]) -> Iterator[Row]:
    size = _sizes(truth)
    for name in model.names:
        if name in truth and name not in model.not_identifiable:
            k = model.names.index(name)
            tolerance = TOLERANCE * max(abs(truth[name]), SMALL * size[name])
            half = NORMAL_95 * float(model.std[k])
            yield Row(name, float(model.theta[k]), half, truth[name], tolerance)


def _sizes(truth: Mapping[str, float]) -> dict[str, float]:
    """Return the natural size of each derivative of both axes."""
    own = {name: abs(truth[name]) for name in ("Z_alpha", "M_alpha", "M_q", "M_delta_e")}
    omega = float(np.sqrt(max(truth["Z_alpha"] * truth["M_q"] - truth["M_alpha"], 1e-6)))
    own |= {"Z_q": 1.0, "Z_delta_e": own["M_delta_e"] / omega}
    return own | dict(natural_size(np.array([truth[name] for name in LATERAL.names.shared])))
