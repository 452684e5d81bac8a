"""The servo lags behind its command, to first or to second order."""

from dataclasses import replace

from advisor.gap.kit.effect import LEAST_S, Effect, Values, Variant, always
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray

_DAMPING = 0.7
"""Damping ratio of the second-order servo, as in position loops that are tuned to be quick without
overshoot."""
LAG = Variant(
    "actuator_lag", "input", ("lag_s",), ((0.02,), (0.1,)), (1e-3,), ((0.0, 1.0),), LEAST_S,
    entries=("lag_s",),
)  # fmt: skip


def _second_order(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set a second-order servo, which trails a ramp like a first-order lag but begins to move more gently."""
    p[:, INDEX["lag_s"]] += values[0]
    p[:, INDEX["lag_damping"]] = _DAMPING


_SECOND = replace(
    LAG, starts=((0.03,), (0.1,)), entries=(), apply_with=_second_order, fixed={"damping": _DAMPING}
)


EFFECT = Effect(
    name="actuator_lag",
    block="input",
    keys={"lag_s": 0.0, "damping": 0.0},
    variants=always(LAG, _SECOND),
    said=(
        "The simulator's elevator is too quick: it lacks {lag_s_ms:.0f} ms of servo lag",
        "The simulator's elevator is too slow: its servo lags by {lag_s_ms:.0f} ms too much",
    ),
    said_beyond="The simulator's elevator is too quick: it lacks {lag_s_ms:.0f} ms more of servo lag",
    said_or="a servo that lags by {lag_s_ms:.0f} ms",
    distinguished_by={
        "transport_delay": "log the measured surface position",
        "actuator_rate_limit": "fly two amplitudes: a rate limit delays larger steps more",
    },
    stated=("elevator", "lag_s"),
    servo={"lag_s": ("lag_s", 1.0), "damping": ("damping", 1.0)},
)
