"""The lift builds up with a lag, alone or with the pitching moment."""

from dataclasses import replace

from advisor.gap.kit.effect import ANY, Effect, Values, Variant, always
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray

_UNSTEADY = Variant(
    "unsteady_lift", "force_equation", ("share", "lag_s"), ((0.1, 0.1), (0.3, 0.4)), (0.005, 0.01),
    ((0.0, 0.95), (0.01, 3.0)), 0.01, entries=("lift_share", "lift_lag_s"),
)  # fmt: skip


def _with_moment(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Let the pitching moment build up with the lift, as on a wing without tail."""
    p[:, INDEX["lift_share"]] += values[0]
    p[:, INDEX["lift_lag_s"]] += values[1]
    p[:, INDEX["moment_share"]] += values[0]


_UNSTEADY_WITH_MOMENT = replace(_UNSTEADY, apply_with=_with_moment, fixed={"with_moment": 1.0})

EFFECT = Effect(
    name="unsteady_lift",
    block="force_equation",
    keys={"share": ANY, "lag_s": 0.0, "with_moment": 0.0},
    variants=always(replace(_UNSTEADY, likewise=(_UNSTEADY_WITH_MOMENT,))),
    said="The real lift builds up with a lag of {lag_s_ms:.0f} ms",
)
