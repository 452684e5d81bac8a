"""The angle of attack has a constant offset, which the climb rate shows."""

from advisor.gap.kit.effect import ANY, Effect, Need, not_fitted
from advisor.gap.records.flights import PreparedManeuvers


def _shows_climb(flights: PreparedManeuvers) -> bool:
    return "climb_rate" in flights.has


EFFECT = Effect(
    name="alpha_bias",
    block="alpha_sensor",
    keys={"bias_rad": ANY},
    variants=not_fitted,
    outside_fits=_shows_climb,
    channel="alpha",
    said=(
        "The angle of attack channel reads {bias_rad_deg:.2f} deg too high",
        "The angle of attack channel reads {bias_rad_deg:.2f} deg too low",
    ),
    need=Need("no climb rate", "VFR_HUD and ATTITUDE at 10 Hz"),
)
