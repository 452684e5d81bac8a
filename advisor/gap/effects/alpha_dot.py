"""The rate of the angle of attack makes a pitching moment."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import FloatArray
from advisor.gap.kit.curve import Curve
from advisor.gap.kit.effect import ANY, Effect, Need, always
from advisor.gap.kit.variant import Variant


def _without_rate_of_alpha(
    derivatives: FloatArray, effects: Sequence[Variant], speed_m_s: float
) -> FloatArray:
    """Return the change of M_α, M_q, M_δe and thrust's moment per M_α̇, with M_α̇ α̇ expanded by Eq. (1).

    The weight's part of α̇ grows with 1/V, the trimmed lift's with V: together with 1 − V², as thrust's.
    """
    z_alpha, z_q, z_delta = derivatives[:3]
    change = [0.0, 0.0, 0.0, -z_alpha, -(1.0 + z_q), -z_delta]
    for effect in effects:
        change += [-GRAVITY_M_S2 / speed_m_s if name == "M_thrust" else 0.0 for name in effect.names]
    return np.array(change)


_RATE = Variant(
    "alpha_dot", "moment_equation", ("M_alpha_dot",), ((0.0,),), (0.02,), ((-20.0, 20.0),), 0.0,
    entries=("M_alpha_dot",), twin=_without_rate_of_alpha,
)  # fmt: skip

EFFECT = Effect(
    name="alpha_dot",
    block="moment_equation",
    keys={"M_alpha_dot": ANY},
    variants=always(_RATE),
    of_the_stick=False,
    said="The rate of the angle of attack makes a pitching moment that the simulator lacks",
    need=Need("M_alpha_dot", "the derivatives mimic it", "pulses of a flap, which move α and not q"),
    imitated_by=(
        "other derivatives of the pitching moment",
        "see which elevator trims level flight at several speeds: there the angle of attack is steady",
    ),
    distinguished_by={"unsteady_lift": "log the accelerometer at a higher rate"},
    curve=Curve("alpha_dot", {"M_alpha_dot": 1}),
)
