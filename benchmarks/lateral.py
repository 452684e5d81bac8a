"""Lateral derivatives and modes of known records against their truth, and the bound in simulation.

    python -m benchmarks.lateral FLIGHTS [--flights-only | --bound-only] [--campaigns 200]

FLIGHTS holds the lateral records (``lateral-*.tlog``) and their aircraft files, to which this file adds what
the README beside the records says of aileron and rudder. Each record runs as ``advisor analyze --axis
lateral``. A figure holds within its tolerance, or where the 95 % interval holds the known value.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from advisor.aircraft.aircraft import Aircraft, Alpha, Beta, SideControl
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.marks_file import LogSeries
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import LateralState
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import predicted
from advisor.oem.axis.problem import AxisProblem, AxisRecord
from advisor.oem.axis.search import solve
from advisor.oem.estimate import NoEstimate
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution
from benchmarks.public.segments import is_rolled, maneuver_of, read_segments, rolled

FORTY = ((500.0, -25.0), (1500.0, 0.0), (2500.0, 25.0))
"""Calibration of 40 us a degree, both positive as in the records."""
MODES = {
    "omega": "dutch_roll_omega",
    "zeta": "dutch_roll_zeta",
    "T_roll": "roll_time_constant",
}


WITHOUT_VANE = Beta("none")


@dataclass(frozen=True)
class Known:
    """What is known of one record."""

    log: str
    aileron: SideControl
    rudder: SideControl
    truth: Mapping[str, tuple[float, float]]
    """Derivative or mode to its value and relative tolerance; a tolerance below 0 is absolute."""
    beta: Beta = WITHOUT_VANE
    said: str = ""
    """What the row says after the name of the log."""
    withheld: str = ""
    """File with manoeuvres that the fit has not seen, of which roll and yaw rate are predicted."""


def _control(output: int, pairs: tuple[tuple[float, float], ...], lag_s: float | None) -> SideControl:
    return SideControl(output, pairs, lag_s, 0.0)


KNOWN = (
    Known(
        "lateral-f16",
        _control(1, ((500.0, -2.5), (1500.0, 0.0), (2500.0, 2.5)), 0.0),
        _control(4, FORTY, 0.0),
        {
            "L_p": (-3.617, 0.02), "L_delta_a": (-41.43, 0.02), "N_beta": (9.341, 0.02),
            "L_beta": (-30.61, 0.03), "N_delta_a": (-1.831, 0.03), "Y_beta": (-0.3172, 0.0),
            "L_r": (0.669, 0.0), "N_r": (-0.4915, 0.0), "omega": (3.232, 0.01), "zeta": (0.1346, -0.004),
            "T_roll": (0.2822, 0.02),
        },
    ),
    Known(
        "lateral-jet",
        _control(1, FORTY, 0.0),
        _control(4, FORTY, 0.0),
        {
            "L_p": (-2.1, 0.06), "L_delta_a": (-6.3, 0.05), "N_beta": (2.92, 0.05),
            "N_delta_r": (-1.7, 0.08), "Y_beta": (-0.20, 0.08), "L_beta": (-3.55, 0.10),
            "omega": (1.81, 0.03), "zeta": (0.085, -0.012), "T_roll": (0.46, 0.06),
        },
    ),
    Known(
        "lateral-cub",
        _control(1, FORTY, None),
        _control(4, FORTY, None),
        {
            "N_beta": (14.0, 0.3), "N_r": (-3.2, 0.3), "N_delta_r": (13.1, 0.3), "N_delta_a": (-10.8, 0.3),
            "L_p": (-4.8, 0.3), "L_delta_a": (32.1, 0.3),
        },
        Beta("aoa_ssa", 0.0),
        withheld="public/sportcub_validation.npz",
    ),
    Known(
        "lateral-business-jet",
        _control(1, FORTY, 0.0),
        _control(4, FORTY, 0.0),
        {"omega": (1.935, 0.03), "zeta": (0.0915, -0.012)},
    ),
    Known(
        "lateral-autopilot",
        _control(1, ((1000.0, 25.0), (1500.0, 0.0), (2000.0, -25.0)), 0.06),
        _control(4, ((1000.0, 25.0), (1500.0, 0.0), (2000.0, -25.0)), 0.06),
        {
            "L_p": (-9.12, 0.06), "L_delta_a": (-39.0, 0.06), "N_beta": (9.24, 0.06),
            "N_delta_r": (-8.20, 0.06), "omega": (3.46, 0.03),
        },
    ),
)  # fmt: skip
KNOWN = (*KNOWN, replace(KNOWN[1], beta=Beta("aoa_ssa", 13.08), said=" with its sideslip vane"))


def analyzed(log: Path, aircraft: Aircraft) -> LateralState:
    """Return the lateral half of a log's analysis."""
    campaign = Campaign(aircraft, lateral=True)
    for columns in LogSeries([log]).batches():
        campaign.feed(columns)
    campaign.finish()
    state = campaign.state.lateral
    assert state is not None
    return state


def rows_of(known: Known, folder: Path) -> Iterator[str]:
    """Yield the rows of one record."""
    aircraft = load_aircraft(folder / f"{known.log}.yaml")
    aircraft = replace(aircraft, aileron=known.aileron, rudder=known.rudder, beta=known.beta)
    state = analyzed(folder / f"{known.log}.tlog", aircraft)
    name_of_row = f"{known.log}{known.said}"
    accepted = sum(one.verdict.accepted for one in state.maneuvers)
    yield f"| {name_of_row} | {accepted} of {len(state.maneuvers)} accepted | | | | |"
    if state.model is None:
        yield f"| {name_of_row} | no joint estimate | | | | |"
        return
    estimate = state.model
    for name, (truth, tolerance) in known.truth.items():
        if name in MODES:
            mode = getattr(state.model.modes, MODES[name])
            value, std = (np.nan, np.nan) if mode is None else (mode.value, mode.std)
        elif name in estimate.not_identifiable:
            yield f"| {name_of_row} | {name} | {truth:g} | not identifiable | | yes |"
            continue
        else:
            value = estimate.value(name)
            std = float(estimate.std[estimate.names.index(name)])
        within = -tolerance if tolerance < 0.0 else tolerance * abs(truth)
        percent = 100.0 * (value / truth - 1.0)
        word = held(value - truth, 1.96 * std, within)
        row = f"{truth:g} | {value:.4g} ± {1.96 * std:.2g} | {percent:+.1f} % | {word} |"
        yield f"| {name_of_row} | {name} | {row}"
    if known.withheld:
        yield from _predicted(name_of_row, state.model, folder / known.withheld)


def held(off: float, half: float, within: float) -> str:
    """Return whether the interval of this half-width holds the known value, or the tolerance alone does."""
    if abs(off) <= half:
        return "yes"
    return "by tolerance" if abs(off) <= within else "NO"


LEAST_R2 = 0.90
"""Share of roll and yaw rate of withheld manoeuvres that the model must explain."""


def _predicted(name_of_row: str, model: AxisEstimate, file: Path) -> Iterator[str]:
    """Yield the shares of roll and yaw rate that a model explains in each withheld manoeuvre, and in all."""
    aircraft = Aircraft(alpha=Alpha("aoa_ssa", 0.0), beta=Beta("aoa_ssa", 0.0))
    wanted = [s for s in read_segments(file) if not s.name.startswith(("elev", "throttle"))]
    segments = list(map(rolled, wanted)) if is_rolled([maneuver_of(s, 1) for s in wanted]) else wanted
    left, whole = np.zeros(2), np.zeros(2)
    for number, segment in enumerate(segments, 1):
        fits = predicted(LATERAL, maneuver_of(segment, number), model, aircraft)
        assert not isinstance(fits, NoEstimate)
        power = np.array([np.sum((fits[n].measured - np.mean(fits[n].measured)) ** 2) for n in ("p", "r")])
        lost = np.array([np.sum(fits[n].residual ** 2) for n in ("p", "r")])
        left, whole = left + lost, whole + power
        yield _share(name_of_row, segment.name, 1.0 - lost / power)
    yield _share(name_of_row, "all withheld", 1.0 - left / whole)


def _share(name_of_row: str, what: str, shares: NDArray[np.float64]) -> str:
    holds = "yes" if min(shares) >= LEAST_R2 else "NO"
    found = f"{shares[0]:.3f}, {shares[1]:.3f}"
    return f"| {name_of_row} | R² of p, r: {what} | ≥ {LEAST_R2:.2f} | {found} | | {holds} |"


JET = {
    "Y_beta": -0.2, "Y_p": 0.0, "Y_r": 0.0, "Y_delta_a": 0.0, "Y_delta_r": 0.04, "L_beta": -3.5, "L_p": -2.1,
    "L_r": 0.7, "L_delta_a": -6.3, "L_delta_r": 1.2, "N_beta": 2.9, "N_p": -0.14, "N_r": -0.12,
    "N_delta_a": -0.3, "N_delta_r": -1.6,
}  # fmt: skip
"""Derivatives of the jet in simulation."""
_NOISE = {"p": 0.004, "r": 0.002, "bank": 0.003, "a_y": 0.05}


def _flown(control: str, seconds: float = 14.0) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
    """Return stamps and noiseless outputs of a doublet, by SciPy's integration."""
    t = np.arange(0.0, seconds, 0.04)
    d, speed, alpha = JET, 130.0, 0.06

    def inputs(now: float) -> tuple[float, float]:
        moved = float(np.interp(now, t, doublet(t)))
        return (moved, 0.0) if control == "aileron" else (0.0, moved)

    def side(now: float, x: NDArray[np.float64]) -> float:
        a, r = inputs(now)
        return d["Y_beta"] * x[0] + d["Y_delta_a"] * a + d["Y_delta_r"] * r

    def rates(now: float, x: NDArray[np.float64]) -> list[float]:
        a, rud = inputs(now)
        beta, p, r, bank = x
        moments = [
            d[f"{m}_beta"] * beta + d[f"{m}_p"] * p + d[f"{m}_r"] * r + d[f"{m}_delta_a"] * a
            + d[f"{m}_delta_r"] * rud
            for m in "LN"
        ]  # fmt: skip
        turn = np.sin(alpha) * p - np.cos(alpha) * r + GRAVITY_M_S2 / speed * np.cos(alpha) * np.sin(bank)
        return [side(now, x) + turn, *moments, p + np.tan(alpha) * r * np.cos(bank)]

    x = solve_ivp(rates, (0.0, t[-1]), np.zeros(4), t_eval=t, rtol=1e-9, atol=1e-11, max_step=0.02).y
    force = np.array([speed * side(now, x[:, i]) for i, now in enumerate(t)])
    return t, {"p": x[1], "r": x[2], "bank": x[3], "a_y": force}


def doublet(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a doublet of 3.5 deg with 1.4 s a step, at stamps ``t`` (n,)."""
    return np.interp(t, [0.0, 1.0, 1.08, 2.4, 2.48, 3.8, 3.88], [0, 0, 0.06, 0.06, -0.06, -0.06, 0.0])


def bound(campaigns: int) -> Iterator[str]:
    """Yield the error over the Cramér-Rao bound, and the coverage of the intervals, over many campaigns."""
    clean = {control: _flown(control) for control in ("aileron", "rudder")}
    rng = np.random.default_rng(61)
    truth = np.array([JET[name] for name in LATERAL.names.reported])
    errors, stated, limits = [], [], []
    for _ in range(campaigns):
        records = []
        for control, (t, outputs) in clean.items():
            noisy = {n: Signal(t, y + rng.normal(0.0, _NOISE[n], len(t))) for n, y in outputs.items()}
            still = {n: Signal(t[[0, -1]], np.full(2, v)) for n, v in
                     (("airspeed", 130.0), ("alpha", 0.06), ("theta", 0.06), ("q", 0.0))}  # fmt: skip
            records.append(AxisRecord({control: Signal(t, doublet(t))}, noisy, **still))
        found = solve(AxisProblem(LATERAL, tuple(records)))
        if not isinstance(found, Solution):
            continue
        errors.append(found.theta - truth)
        stated.append(np.sqrt(np.diag(found.widened)[: len(truth)]))
        limits.append(np.sqrt(np.diag(found.covariance_cr)[: len(truth)]))
    off, std, least = np.array(errors), np.array(stated), np.array(limits)
    yield f"{len(off)} of {campaigns} campaigns with an estimate"
    yield "| derivative | error over bound | coverage of 95 % |"
    yield "|---|---|---|"
    for k, name in enumerate(LATERAL.names.reported):
        ratio = float(np.sqrt(np.mean(off[:, k] ** 2)) / np.mean(least[:, k]))
        inside = 100.0 * float(np.mean(np.abs(off[:, k]) <= 1.96 * std[:, k]))
        yield f"| {name} | {ratio:.2f} | {inside:.1f} % |"
    inside = 100.0 * float(np.mean(np.abs(off) <= 1.96 * std))
    yield f"| all | {np.sqrt(np.mean((off / least) ** 2)):.2f} | {inside:.1f} % |"


def main() -> int:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--flights-only", action="store_true")
    parser.add_argument("--bound-only", action="store_true")
    parser.add_argument("--campaigns", type=int, default=200)
    asked = parser.parse_args()
    if not asked.bound_only:
        print("| record | quantity | known | found, ± 95 % | off | holds |\n|---|---|---|---|---|---|")
        for known in KNOWN:
            for row in rows_of(known, asked.folder):
                print(row, flush=True)
    if not asked.flights_only:
        for row in bound(asked.campaigns):
            print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
