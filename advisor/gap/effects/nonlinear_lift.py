"""The lift is nonlinear in the angle of attack, or the flow separates."""

from collections.abc import Sequence

import numpy as np

from advisor.gap.kit.effect import ANY, Curve, Effect, Variant, bent
from advisor.gap.records.flights import PreparedManeuvers

_CURVE = Curve("alpha", {"Z_alpha2": 2, "Z_alpha3": 3})
_CURVED = Variant(
    "nonlinear_lift", "force_equation", ("Z_alpha2", "Z_alpha3"), ((0.0, 0.0),), (0.5, 5.0),
    ((-500.0, 500.0), (-1e4, 1e4)), 0.0, entries=("Z_alpha2", "Z_alpha3"),
)  # fmt: skip


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    return (bent(_CURVED, _CURVE, flights), *_stall(flights))


def _stall(flights: PreparedManeuvers) -> Sequence[Variant]:
    """Return flow separation about an angle of attack (Kirchhoff's flow): a kink, unlike any parabola."""
    if "alpha" not in flights.channels:
        return ()
    trim = float(np.median([f.alpha_trim for f in flights.flights]))
    top = max(float(np.max(f.outputs["alpha"].y)) for f in flights.flights)
    separated = Variant(
        "nonlinear_lift",
        "force_equation",
        ("stall_rad", "sharpness"),
        ((trim + 0.5 * (top - trim), 40.0), (top, 40.0), (top + 0.03, 20.0)),
        (0.002, 0.5),
        ((0.0, 1.0), (2.0, 200.0)),
        0.0,
        entries=("stall_rad", "stall_sharpness"),
    )
    return (separated,)


EFFECT = Effect(
    name="nonlinear_lift",
    block="force_equation",
    keys={"Z_alpha2": ANY, "Z_alpha3": ANY, "about_rad": ANY, "stall_rad": ANY, "sharpness": 0.0},
    variants=_variants,
    said="The real lift is not linear in the angle of attack",
    said_beyond="The curve of lift over the angle of attack differs from the simulator's",
    curve=_CURVE,
)
