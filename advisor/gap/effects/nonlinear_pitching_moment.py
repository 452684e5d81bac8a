"""The pitching moment is nonlinear in the angle of attack."""

from advisor.gap.kit.effect import ANY, Curve, Effect, Variant, bending

_CURVE = Curve("alpha", {"M_alpha2": 2, "M_alpha3": 3})
_CURVED = Variant(
    "nonlinear_pitching_moment", "moment_equation", ("M_alpha2", "M_alpha3"), ((0.0, 0.0),), (5.0, 50.0),
    ((-5e3, 5e3), (-1e5, 1e5)), 0.0, entries=("M_alpha2", "M_alpha3"),
)  # fmt: skip

EFFECT = Effect(
    name="nonlinear_pitching_moment",
    block="moment_equation",
    keys={"M_alpha2": ANY, "M_alpha3": ANY, "about_rad": ANY},
    variants=bending(_CURVED, _CURVE),
    said="The real pitching moment is not linear in the angle of attack",
    said_beyond="The curve of pitching moment over the angle of attack differs from the simulator's",
    curve=_CURVE,
)
