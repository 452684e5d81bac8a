"""The elevator's moment is nonlinear in its deflection."""

from advisor.gap.kit.effect import ANY, Curve, Effect, Variant, bending

_CURVE = Curve("delta_e", {"M_delta2": 2, "M_delta3": 3})
_CURVED = Variant(
    "elevator_nonlinearity", "moment_equation", ("M_delta2", "M_delta3"), ((0.0, 0.0),), (5.0, 100.0),
    ((-2e4, 2e4), (-2e6, 2e6)), 0.0, entries=("M_delta2", "M_delta3"),
)  # fmt: skip

EFFECT = Effect(
    name="elevator_nonlinearity",
    block="moment_equation",
    keys={"M_delta2": ANY, "M_delta3": ANY, "about_rad": ANY},
    variants=bending(_CURVED, _CURVE),
    said="The real elevator's moment is not proportional to its deflection",
    said_beyond="The curve of the elevator's moment over its deflection differs from the simulator's",
    distinguished_by={"nonlinear_pitching_moment": "fly slow and fast steps of equal size"},
    curve=_CURVE,
)
