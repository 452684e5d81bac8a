"""A gust disturbs the flight once or a few times."""

from advisor.gap.kit.effect import ANY, Effect, Need, not_fitted

EFFECT = Effect(
    name="gust",
    block="air",
    keys={"amplitude_m_s": ANY, "length_m": 0.0, "at_s": ANY},
    variants=not_fitted,
    outside_fits=lambda _: True,
    of_one_flight=True,
    said=(
        "An upward gust of {amplitude_m_s:.2g} m/s passed",
        "A downward gust of {amplitude_m_s:.2g} m/s passed",
    ),
    need=Need("no angle of attack", "AOA_SSA at 50 Hz, or a vane"),
)
