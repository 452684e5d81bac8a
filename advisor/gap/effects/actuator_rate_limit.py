"""The servo moves no faster than a limit."""

from advisor.gap.kit.effect import Effect, Variant, always

# The search uses the slowness 1/ρ: zero means no limit, and the cost is smooth there.
RATE_LIMIT = Variant(
    "actuator_rate_limit", "input", ("rate_rad_s",), ((0.4,), (1.2,), (3.0,)), (0.02,), ((0.0, 30.0),), 0.05,
    entries=("slowness_s_rad",), inverted=True,
)  # fmt: skip

EFFECT = Effect(
    name="actuator_rate_limit",
    block="input",
    keys={"rate_rad_s": 0.0},
    variants=always(RATE_LIMIT),
    said=(
        "The real elevator moves no faster than {rate_rad_s_deg:.0f} deg/s",
        "The simulator's elevator reaches at most {rate_rad_s_deg:.0f} deg/s, but the real one is faster",
    ),
    distinguished_by={"transport_delay": "fly two amplitudes: a rate limit delays larger steps more"},
    servo={"rate_rad_s": ("rate_rad_s", 1.0)},
)
