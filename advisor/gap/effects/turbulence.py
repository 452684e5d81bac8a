"""Turbulence disturbs the whole flight."""

from advisor.gap.kit.effect import Effect, Need, not_fitted

EFFECT = Effect(
    name="turbulence",
    block="air",
    keys={"sigma_w_m_s": 0.0, "length_m": 0.0},
    variants=not_fitted,
    outside_fits=lambda _: True,
    of_one_flight=True,
    said="The air was not still: gusts of about {sigma_w_m_s:.2g} m/s",
    need=Need("no angle of attack", "AOA_SSA at 50 Hz, or a vane"),
    distinguished_by={"gust": "fly more manoeuvres: turbulence recurs in each, a single gust does not"},
)
