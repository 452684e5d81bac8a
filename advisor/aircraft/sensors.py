"""Instruments of the aircraft file: angle of attack, sideslip, accelerometer."""

from dataclasses import dataclass
from typing import Annotated

from advisor.aircraft.key import Key


@dataclass(frozen=True)
class Beta:
    """Source of the sideslip."""

    source: Annotated[str, Key(
        "auto | aoa_ssa | named_value:NAME | none, positive with wind from the right. ``auto`` uses what "
        "a vane measures, and nothing that an autopilot derives.",
        example="auto",
    )] = "auto"  # fmt: skip
    vane_arm_m: Annotated[float | None, Key(
        "Distance of the sideslip vane ahead of the centre of gravity, m. None: that of the angle of attack.",
        example="0.0",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Alpha:
    """Source of the angle of attack."""

    source: Annotated[str, Key(
        "auto | aoa_ssa | derived | named_value:NAME | none. With ``none`` the estimate uses no angle of "
        "attack.",
        example="auto",
        question="Angle of attack from: auto, aoa_ssa, derived, none, or named_value:NAME",
        answer="auto",
    )] = "auto"  # fmt: skip
    vane_arm_m: Annotated[float | None, Key(
        "Distance of the vane ahead of the centre of gravity, m. None: unknown. 0: the log has corrected "
        "angles.",
        example="0.0",
        question="Distance of the vane ahead of the centre of gravity, m",
        cost="The place of the vane is estimated with the derivatives: wider intervals of Z_α and Z_q.",
        mend="measure the distance along the fuselage",
    )] = None  # fmt: skip


@dataclass(frozen=True)
class Accelerometer:
    """Position of the accelerometer."""

    arm_m: Annotated[float | None, Key(
        "Distance of the IMU ahead of the centre of gravity, m. None: unknown.",
        example="0.0",
        question="Distance of the autopilot ahead of the centre of gravity, m",
        cost=(
            "The accelerometer counts as at the centre of gravity, unless alpha.vane_arm_m is given: then"
            " its place is estimated."
        ),
        mend="measure the distance along the fuselage",
    )] = None  # fmt: skip
