"""The surface moves a constant time after its command."""

from advisor.gap.kit.effect import LEAST_S, Effect, Values, Variant, always
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray


def _delay(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set the total delay of the command, which includes the delay of telemetry."""
    p[:, INDEX["delay_s"]] += values[0]
    p[:, INDEX["latency_s"]] = 0.0


DELAY = Variant(
    "transport_delay", "input", ("delay_s",), ((0.005,), (0.03,), (0.1,)), (1e-3,), ((0.0, 0.5),), LEAST_S,
    apply_with=_delay,
)  # fmt: skip
"""Total delay between command and surface. A model without the effect has the delay of telemetry
(``latency``), so only a longer delay changes the outputs."""

EFFECT = Effect(
    name="transport_delay",
    block="input",
    keys={"delay_s": 0.0},
    variants=always(DELAY),
    said=(
        "The simulator responds {delay_s_ms:.0f} ms too early: a delay between command and surface",
        "The simulator responds {delay_s_ms:.0f} ms too late: its delay is too long",
    ),
    said_beyond="The simulator responds {delay_s_ms:.0f} ms too early: the delay between command and "
    "surface is longer than its own",
    said_or="a delay of {delay_s_ms:.0f} ms",
    imitated_by=("an equal delay of every logged stream", "log the measured surface position"),
    stated=("elevator", "delay_s"),
    servo={"delay_s": ("delay_s", 1.0)},
)
