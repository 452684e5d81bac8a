"""The linkage between servo and surface has play."""

import numpy as np

from advisor.gap.kit.effect import SMALL_ANGLE_RAD, Effect, Variant, always

BACKLASH = Variant(
    "actuator_backlash", "input", ("half_width_rad",), ((0.003,), (0.008,), (0.02,)), (2e-4,),
    ((0.0, 0.1),), SMALL_ANGLE_RAD, entries=("half_play_rad",),
    sides=("play_side", tuple(np.linspace(-1.0, 1.0, 8))),
)  # fmt: skip

EFFECT = Effect(
    name="actuator_backlash",
    block="input",
    keys={"half_width_rad": 0.0},
    variants=always(BACKLASH),
    said=(
        "The real elevator has play of {half_width_rad_deg:.2f} deg to either side",
        "The simulator's elevator has {half_width_rad_deg:.2f} deg too much play to either side",
    ),
    distinguished_by={"actuator_deadband": "fly two amplitudes, and steps short of neutral"},
    servo={"half_width_rad": ("play_rad", 2.0)},
)
