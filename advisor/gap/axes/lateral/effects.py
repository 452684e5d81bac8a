"""Effects of roll and yaw: the pitch axis' effects at aileron, rudder and lateral instruments.

Names, blocks, bounds, starts, least sizes and sentences are those of ``gap.effects``. A row adds the control
or output, and the prior standard deviation of each parameter.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.gap.axes.lateral.setting import COMMAND, PROPELLER, Flown, Place
from advisor.gap.effects.accelerometer_offset import ARM
from advisor.gap.effects.actuator_backlash import BACKLASH
from advisor.gap.effects.actuator_deadband import DEADBAND_ABOUT_TRIM
from advisor.gap.effects.actuator_lag import LAG
from advisor.gap.effects.actuator_rate_limit import RATE_LIMIT
from advisor.gap.effects.pitch_rate_scale import SCALE
from advisor.gap.effects.thrust_moment import EFFECT as THRUST
from advisor.gap.effects.thrust_moment import THROTTLE_MOVES
from advisor.gap.effects.transport_delay import DELAY
from advisor.gap.inference.sizes import width_of
from advisor.gap.kit.effect import without_sizes
from advisor.gap.kit.least import FILTERED_S
from advisor.gap.kit.skew import skew_beyond
from advisor.gap.kit.variant import Variant
from advisor.gap.result import Unseen, spelled
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.disturbance import SENSORS
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class SideEffect:
    """One effect of roll and yaw at one control or output."""

    of: str
    """Control or output at which the effect acts; ``throttle`` for the propeller."""
    variant: Variant
    places: tuple[Place, ...]
    """Entry of the simulator that each parameter of the effect sets."""
    std: tuple[float, ...]
    """Prior standard deviation of each parameter about zero, over all aircraft that have the effect. Where
    the bounds exclude negative sizes, the prior is half of a Gaussian."""
    words: Mapping[str, str] = field(default_factory=dict)
    """Word of this axis for each word in the pitch axis' sentence."""
    columns: FloatArray | None = field(default=None, compare=False)
    """(N, k) change of the outputs per unit of each parameter, where it is linear."""

    @property
    def named(self) -> str:
        """Name of the effect in sentences: ``aileron actuator lag``, ``roll rate scale``."""
        spoken = spelled(self.variant.effect)
        for old, new in self.words.items():
            spoken = spoken.replace(old, new)
        return f"{self.of} {spoken}" if self.of in LATERAL.inputs else spoken

    @property
    def name(self) -> str:
        """Name of the effect in documents: ``aileron_actuator_lag``, ``roll_rate_scale``."""
        return self.named.replace(" ", "_")

    def said(self, sentence: str) -> str:
        """Return the pitch axis' sentence with the words of roll and yaw."""
        for old, new in self.words.items():
            if old in sentence:
                return sentence.replace(old, new)
        return sentence if not self.words else f"{self.of.capitalize()}: {sentence[0].lower()}{sentence[1:]}"

    @property
    def starts(self) -> tuple[tuple[float, ...], ...]:
        """Sizes at which a search starts; empty if the outputs are linear in the size."""
        return tuple(start for start in self.variant.starts if start[0])

    @property
    def sides(self) -> tuple[Place, tuple[float, ...]] | None:
        """Parameter whose value differs by manoeuvre, with the values to choose from; None without one."""
        return None if self.variant.sides is None else ((self.of, self.variant.sides[0]), (-1.0, 0.0, 1.0))


_BLOCKS = {output: block for block, output in SENSORS.items()}
_BLOCKS |= {"throttle": "rolling_moment", "command": "input"}
"""Block of each output, of the throttle and of all commands, by its name; a control is a block itself."""
_SERVO = (
    (LAG, ("lag_s",)),
    (DELAY, ("delay_s",)),
    (RATE_LIMIT, ("slowness_s_rad",)),
    (BACKLASH, ("half_play_rad",)),
    (DEADBAND_ABOUT_TRIM, ("half_deadband_rad", "neutral_rad")),
)
"""Effects of a servo, each with its entries in the simulator."""
_READINGS = {
    "p": ("roll rate", "pitch_rate_skew", "pitch_rate_sensor"),
    "r": ("yaw rate", "pitch_rate_skew", "pitch_rate_sensor"),
    "bank": ("attitude", "attitude_skew", ""),
    "a_y": ("lateral acceleration", "accelerometer_skew", "accelerometer"),
    "beta": ("sideslip", "alpha_skew", "alpha_sensor"),
}
"""Name of each output, its skew effect in pitch, and the block of its scale error, if any."""
_ARM_STD_M = 0.3
"""Prior: standard deviation of the arm of an accelerometer or of a vane, m."""


def block_of(of: str) -> str:
    """Return the block of a control, of an output, of the throttle or of the air."""
    return _BLOCKS.get(of, of)


def side_effects(flown: Flown) -> Iterator[SideEffect]:
    """Yield every lateral effect that the records of a flight can show."""
    problem = flown.problem
    controls = list(filter(problem.flies, LATERAL.inputs))
    for of in controls:
        for variant, entries in _SERVO:
            yield _sized(of, variant, tuple((of, entry) for entry in entries), {"elevator": of})
    if len(controls) > 1:
        # A delay before the commands part delays all surfaces equally, and is one cause.
        words = {"transport": "common transport", "command and surface": "all commands and surfaces"}
        yield _sized("command", replace(DELAY, starts=()), (COMMAND,), words)
    measured = set.intersection(*(set(record.outputs) for record in problem.records))
    for of in filter(measured.__contains__, _READINGS):
        spoken, skew, block = _READINGS[of]
        words = dict.fromkeys(("pitch rate", "angle of attack"), spoken)
        yield _sized(of, skew_beyond(skew, FILTERED_S), ((of, "skew_s"),), words)
        if block:
            yield _sized(of, replace(SCALE, block=block), ((of, "scale"),), {"pitch rate": spoken})
    if "a_y" in measured:
        yield SideEffect("a_y", ARM, (("a_y", "arm_m"),), (_ARM_STD_M,))
    if "beta" in measured and flown.arm_is_stated:
        vane = replace(ARM, effect="alpha_vane_offset", block="alpha_sensor")
        yield SideEffect("beta", vane, (("beta", "arm_m"),), (_ARM_STD_M,))
    if _throttle_moves(flown):
        yield _propeller()


def _sized(of: str, variant: Variant, places: tuple[Place, ...], words: Mapping[str, str]) -> SideEffect:
    """Return an effect with the prior widths of the pitch axis, whose servos and streams are the same."""
    std = tuple(width_of(variant.effect, name) for name in variant.names)
    return SideEffect(of, variant, places, std, words)


def unseen(flown: Flown) -> Iterator[Unseen]:
    """Yield the effects that the records cannot show."""
    yield Unseen(
        "a constant error of p, r, φ or the lateral acceleration",
        "each manoeuvre has its own trim and biases",
        "a reading of each instrument at rest",
    )
    for of in LATERAL.inputs:
        if not flown.problem.flies(of):
            yield Unseen(f"the servo of the {of}", f"the {of} is not flown", f"a doublet of the {of}")
    if not _throttle_moves(flown):
        yield Unseen("propeller roll", "the throttle stands still", "steps of the throttle in a manoeuvre")


def _throttle_moves(flown: Flown) -> bool:
    return any(t is not None and np.ptp(t.y) > THROTTLE_MOVES for t in flown.throttle)


def _propeller() -> SideEffect:
    """Return the propeller's rolling moment at full throttle as the equivalent aileron deflection."""
    torque = replace(
        ARM, effect="thrust_moment", block="moment_equation", names=("aileron_rad",), steps=(2e-4,)
    )
    words = dict.fromkeys(without_sizes(THRUST.said, ""), "The propeller rolls the real aircraft")
    return SideEffect("throttle", torque, (PROPELLER,), (0.05,), {**words, "thrust moment": "propeller roll"})
