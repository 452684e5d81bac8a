"""The advisor's own estimates of both axes, as coefficients of the whole model.

Elevator segments give the short period, the other moved controls give roll and yaw. The advisor has no model
of drag and thrust: these coefficients come from the regression.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Alpha, Beta
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.library import estimate
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.process.arrays import FloatArray
from benchmarks.public.linear import FACTORS, FREE, REFERENCE_M_S, ROWS
from benchmarks.public.segments import STROKE_RAD, Segment, maneuver_of

AIRCRAFT = Aircraft(alpha=Alpha("aoa_ssa", 0.0), beta=Beta("aoa_ssa", 0.0))
"""Angles of attack and sideslip are measured at the centre of gravity."""
PITCH = {"0": "0", "alpha": "alpha", "q": "q", "delta_e": "elevator"}
"""Subscript of a derivative of the short period to the factor of the whole model."""
SIDE = {"beta": "beta", "p": "p", "r": "r", "delta_a": "aileron", "delta_r": "rudder"}
"""Subscript of a lateral derivative to the factor of the whole model."""


@dataclass(frozen=True)
class Advised:
    """The advisor's estimates of both axes."""

    pitch: Estimate
    side: AxisEstimate

    @property
    def untold(self) -> tuple[str, ...]:
        """Derivatives that the training segments do not tell."""
        return (*self.pitch.not_identifiable, *self.side.not_identifiable)

    @property
    def lags_s(self) -> Mapping[str, float]:
        """Lag of each control's servo, s."""
        side = {
            name: self.side.nuisances.get(f"{name}_lag_s", (0.0, 0.0))[0] for name in ("aileron", "rudder")
        }
        return {"elevator": self.pitch.servo_lag_s, **side}


def advised(train: Sequence[Segment]) -> Advised | NoEstimate:
    """Return the advisor's estimates from the training segments, or why there are none."""
    by_control: dict[str, list[Segment]] = {"elevator": [], "side": []}
    for segment in train:
        motion = {name: float(np.ptp(segment.commands[name])) for name in ("elevator", "aileron", "rudder")}
        moved = max(motion, key=lambda name: motion[name])
        if motion[moved] > 0.0:
            by_control["elevator" if moved == "elevator" else "side"].append(segment)
    flown = {name: [maneuver_of(s, n) for n, s in enumerate(some, 1)] for name, some in by_control.items()}
    pitch = estimate(flown["elevator"], AIRCRAFT)
    side = estimate_axis(LATERAL, flown["side"], AIRCRAFT)
    if isinstance(pitch, NoEstimate):
        return pitch
    return side if isinstance(side, NoEstimate) else Advised(pitch, side)


def coefficients_of(found: Advised, regressed: FloatArray) -> FloatArray:
    """Return the coefficients (6, 11) of the estimates, with drag and thrust of a regression (6, 11)."""
    filled = np.where(FREE & (np.array(ROWS) == "X")[:, None], regressed, 0.0)
    filled[ROWS.index("Z"), FACTORS.index("one")] = -GRAVITY_M_S2
    for estimated, factor_of in ((found.pitch, PITCH), (found.side, SIDE)):
        ratio = REFERENCE_M_S / (estimated.airspeed_m_s or REFERENCE_M_S)
        for name in estimated.names:
            row, of = name.split("_", 1)
            size = REFERENCE_M_S / ratio if row in "YZ" else 1.0
            size *= ratio if of in "pqr" else ratio * ratio
            size *= STROKE_RAD if of.startswith("delta") else 1.0
            filled[ROWS.index(row), FACTORS.index(factor_of[of])] = size * estimated.value(name)
    return filled


def lagged(segment: Segment, lags_s: Mapping[str, float]) -> Segment:
    """Return the segment with commands as they leave servos of first order, which begin at rest."""
    commands = dict(segment.commands)
    for name, lag_s in lags_s.items():
        if lag_s <= 0.0:
            continue
        after = commands[name].copy()
        for i, step_s in enumerate(np.diff(segment.t)):
            after[i + 1] = after[i] + (1.0 - np.exp(-step_s / lag_s)) * (commands[name][i] - after[i])
        commands[name] = after
    return replace(segment, commands=commands)
