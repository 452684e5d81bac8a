"""The rate of the angle of attack makes a pitching moment."""

from advisor.gap.kit.effect import ANY, Curve, Effect, Need, Variant, always

_RATE = Variant(
    "alpha_dot", "moment_equation", ("M_alpha_dot",), ((0.0,),), (0.02,), ((-20.0, 20.0),), 0.0,
    entries=("M_alpha_dot",),
)  # fmt: skip

EFFECT = Effect(
    name="alpha_dot",
    block="moment_equation",
    keys={"M_alpha_dot": ANY},
    variants=always(_RATE),
    of_the_stick=False,
    said="The rate of the angle of attack makes a pitching moment that the simulator lacks",
    need=Need("the derivatives mimic it", "pulses of a flap, which move α and not q"),
    imitated_by=(
        "other derivatives of the pitching moment",
        "compare the elevator that trims level flight at several speeds: the angle of attack is then steady",
    ),
    distinguished_by={"unsteady_lift": "log the accelerometer at a higher rate"},
    curve=Curve("alpha_dot", {"M_alpha_dot": 1}),
)
