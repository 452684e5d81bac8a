"""Effects of an axis: those of the catalogue at its controls and instruments.

Names, blocks, bounds, starts, least sizes and sentences are those of ``gap.effects``. A row adds the control
or output, and the prior standard deviation of each parameter.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.gap.axis.setting import DRIFT, EXPONENT, THROTTLE, Flown
from advisor.gap.effects import EFFECTS as CATALOGUE
from advisor.gap.effects.accelerometer_offset import ARM
from advisor.gap.effects.actuator_backlash import BACKLASH
from advisor.gap.effects.actuator_deadband import DEADBAND_ABOUT_TRIM
from advisor.gap.effects.actuator_lag import LAG
from advisor.gap.effects.actuator_rate_limit import RATE_LIMIT
from advisor.gap.effects.airspeed_variation import ONE_POWER
from advisor.gap.effects.pitch_rate_scale import SCALE
from advisor.gap.effects.thrust_moment import AT_ONCE, BEHIND, THROTTLE_MOVES
from advisor.gap.effects.thrust_moment import EFFECT as THRUST
from advisor.gap.effects.transport_delay import DELAY
from advisor.gap.inference.sizes import ARM_SHARES, width_of
from advisor.gap.inference.with_motion import WITNESSES
from advisor.gap.kit.effect import FILTERED_S, Variant, skew_beyond, without_sizes
from advisor.gap.result import Unseen, spelled
from advisor.model.axis import Axis, Place
from advisor.oem.axis.parameter import moves_in
from advisor.oem.axis.problem import COMMAND
from advisor.oem.prepare import SPEED_CHANGE
from advisor.process.arrays import FloatArray
from advisor.words.quantities import channel


@dataclass(frozen=True, slots=True)
class AxisEffect:
    """One effect at one control or output of an axis."""

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
    at_control: bool = False
    """Whether the effect acts at a control, whose name its own name contains."""
    columns: FloatArray | None = field(default=None, compare=False)
    """(N, k) change of the outputs per unit of each parameter, where it is linear."""

    @property
    def kind(self) -> str:
        """Key of a change of derivatives in the axis' table; another effect's place."""
        return self.places[0][0].partition("@")[0]

    @property
    def named(self) -> str:
        """Name of the effect in sentences: ``aileron actuator lag``, ``roll rate scale``."""
        spoken = spelled(self.variant.effect)
        for old, new in self.words.items():
            spoken = spoken.replace(old, new)
        return f"{self.of} {spoken}" if self.at_control else spoken

    @property
    def name(self) -> str:
        """Name of the effect in documents: ``aileron_actuator_lag``, ``roll_rate_scale``."""
        return self.named.replace(" ", "_")

    def said(self, sentence: str) -> str:
        """Return the pitch axis' sentence with the words of this axis."""
        for old, new in self.words.items():
            if old in sentence:
                return sentence.replace(old, new)
        return sentence if not self.words else f"{self.of.capitalize()}: {sentence[0].lower()}{sentence[1:]}"

    @property
    def starts(self) -> tuple[tuple[float, ...], ...]:
        """Sizes at which a search starts; empty if the outputs are linear in the size."""
        return tuple(start for start in self.variant.starts if start[0])

    @property
    def begins(self) -> list[tuple[float, ...]]:
        """Sizes about which the outputs are taken as linear: none of an effect, at each tabulated position,
        time or rate."""
        nothing = (0.0,) * len(self.places)
        return [start for start in self.variant.starts if not start[0]] or [nothing]

    @property
    def sides(self) -> tuple[Place, tuple[float, ...]] | None:
        """Parameter whose value differs by manoeuvre, with the values to choose from; None without one."""
        return None if self.variant.sides is None else ((self.of, self.variant.sides[0]), (-1.0, 0.0, 1.0))


_SERVO = (
    (LAG, ("lag_s",)),
    (DELAY, ("delay_s",)),
    (RATE_LIMIT, ("slowness_s_rad",)),
    (BACKLASH, ("half_play_rad",)),
    (DEADBAND_ABOUT_TRIM, ("half_deadband_rad", "neutral_rad")),
)
"""Effects of a servo, each with its entries in the simulator."""
_ARM_STD_M = 0.3
"""Prior: standard deviation of the arm of an accelerometer or of a vane, m."""


def block_of(axis: Axis, of: str) -> str:
    """Return the block of an output, of the throttle or of all commands; any other name is a block itself."""
    blocks = {output: block for block, output in axis.sensors.items()}
    turned = next((t.state for t in axis.shared if t.factor == axis.propeller[0]), "")
    turned = next((m.state for place, m in axis.moments.items() if place[0] == THROTTLE), turned)
    by_state = {state: block for block, state in axis.equations.items()}
    return {**axis.blocks, **blocks, "throttle": by_state.get(turned, ""), "command": "input"}.get(of, of)


def axis_effects(flown: Flown) -> Iterator[AxisEffect]:
    """Yield every effect that the records of a flight can show, apart from nonlinear ones."""
    axis = flown.axis
    yield from _of_servos(flown)
    yield from _of_instruments(flown)
    if axis.propeller[0] and _throttle_moves(flown):
        yield _propeller(*axis.propeller)
    yield from _by_moments(flown)
    yield from (effect for effect in changes_of(flown) if axis.changes[effect.kind].has_name)
    speeds = np.concatenate([r.airspeed.y for r in flown.problem.records])
    varied = flown.problem.reference_airspeed_m_s and np.ptp(speeds) > SPEED_CHANGE * np.mean(speeds)
    if axis.changes and varied:
        yield _sized(ONE_POWER.block, ONE_POWER, (EXPONENT,), {})


def _of_servos(flown: Flown) -> Iterator[AxisEffect]:
    """Yield the effects between the commands and the surfaces."""
    axis, controls = flown.axis, list(filter(flown.problem.flies, flown.axis.inputs))
    for of in controls:
        for variant, entries in _SERVO:
            places = tuple((of, entry) for entry in entries)
            yield _sized(of, variant, places, {"elevator": of}, at_control=of not in axis.blocks)
    if len(controls) > 1:
        # A delay before the commands part delays all surfaces equally, and is one cause.
        words = {"transport": "common transport", "command and surface": "all commands and surfaces"}
        yield _sized("command", replace(DELAY, starts=()), (COMMAND,), words)


def _of_instruments(flown: Flown) -> Iterator[AxisEffect]:
    """Yield the effects in the readings."""
    axis, hidden = flown.axis, flown.axis.hidden
    measured = set.intersection(*(set(record.outputs) for record in flown.problem.records))
    for of in filter(measured.__contains__, axis.readings):
        spoken, skew, block = axis.readings[of]
        words = dict.fromkeys(("pitch rate", "angle of attack"), spoken)
        yield _sized(of, skew_beyond(skew, FILTERED_S), ((of, "delay_s"),), words)
        if block:
            yield _sized(of, replace(SCALE, block=block), ((of, "scale"),), {"pitch rate": spoken})
    if axis.force in measured:
        yield AxisEffect(axis.force, ARM, ((axis.force, "arm_m"),), (_arm_std_m(flown, ARM.effect),))
    vane = replace(ARM, effect="alpha_vane_offset", block="alpha_sensor", bounds=((-100.0, 100.0),))
    for of in measured.intersection(axis.arms) if flown.arm_is_stated or axis.arms_are_causes else ():
        yield AxisEffect(of, vane, ((of, "arm_m"),), (_arm_std_m(flown, vane.effect),))
    if axis.computed and hidden in measured:
        scale = replace(SCALE, effect="alpha_scale", block="alpha_sensor")
        yield _sized(hidden, scale, ((hidden, "scale"),), {})
        lag = Variant("alpha_lag", "alpha_sensor", ("lag_s",), ((0.0,),), (0.01,), ((0.0, 1.0),), FILTERED_S)
        yield _sized(hidden, lag, ((hidden, "filter_s"),), {})


def _by_moments(flown: Flown) -> Iterator[AxisEffect]:
    """Yield the moments of known signals that not every aircraft has, such as the thrust's."""
    axis = flown.axis
    for place, moment in axis.moments.items():
        showing = [r.signals for r in flown.problem.records if moves_in(r, moment.signals)]
        moves = max((float(np.ptp(signals[n].y)) for signals in showing for n in moment.signals), default=0.0)
        if not np.isfinite(moment.std) and moves > THROTTLE_MOVES:
            # Half of the moment of the largest flown deflection.
            (control,) = axis.inputs
            of = next(t.name for t in axis.shared if (t.factor, t.state) == (control, moment.state))
            std = 0.5 * abs(flown.derivatives[of]) * max(0.02, flown.problem.motion(control) / 2.0)
            yield AxisEffect(place[0], AT_ONCE, (place,), (std,))
            lag = width_of(BEHIND.effect, BEHIND.names[1])
            yield AxisEffect(place[0], BEHIND, (place, (place[0], "lag_s")), (std, lag))


def changes_of(flown: Flown) -> Iterator[AxisEffect]:
    """Yield every change of derivatives that begins with a manoeuvre, or that grows steadily."""
    count = len(flown)
    if count < WITNESSES:
        return
    block = {effect.name: effect.block for effect in CATALOGUE.values()}
    begins, ends = flown.begins_s, flown.ends_s
    span_s = max(float(begins[-1] - begins[0]), 1.0)
    for kind, change in flown.axis.changes.items():
        k = len(change.names)
        variant = Variant(
            change.effect, block.get(change.effect, "input"), change.names, ((0.0,) * k,), (0.005,) * k,
            change.bounds, 0.01, fixed=change.fixed,
        )  # fmt: skip
        for since in [*range(1, count)] if k > 1 else [DRIFT, *range(1, count)]:
            if since == DRIFT:
                form = replace(variant, in_file={"rate_per_s": ("step", span_s)})
            else:
                at_s = 0.5 * float(ends[since - 1] + begins[since])
                form = replace(variant, fixed={**change.fixed, "at_s": at_s})
            places = tuple((f"{kind}@{since}", name) for name in change.names)
            yield AxisEffect(form.block, form, places, (change.std,) * k)


def _arm_std_m(flown: Flown, effect: str) -> float:
    """Return the prior standard deviation of an arm, m: a share of the way flown in a radian of the fastest
    mode."""
    if not flown.axis.arms_are_causes:
        return _ARM_STD_M
    theta = np.array([flown.derivatives[name] for name in flown.axis.names.shared])
    fastest = float(np.max(np.abs(np.linalg.eigvals(flown.problem.linear(theta, 0).matrix))))
    return ARM_SHARES[effect] * flown.problem.mean_airspeed_m_s / max(fastest, 0.5)


def _sized(
    of: str, variant: Variant, places: tuple[Place, ...], words: Mapping[str, str], at_control: bool = False
) -> AxisEffect:
    """Return an effect with the prior widths of the pitch axis, whose servos and streams are the same."""
    std = tuple(width_of(variant.effect, name) for name in variant.names)
    return AxisEffect(of, variant, places, std, words, at_control)


def unseen(flown: Flown) -> Iterator[Unseen]:
    """Yield the effects that the records cannot show."""
    yield Unseen(
        f"a constant error of {_outputs_said(flown)}",
        "each manoeuvre has its own trim and biases",
        "a reading of each instrument at rest",
    )
    for of in flown.axis.inputs:
        if not flown.problem.flies(of):
            yield Unseen(f"the servo of the {of}", f"the {of} is not flown", f"a doublet of the {of}")
    if flown.axis.propeller[0] and not _throttle_moves(flown):
        yield Unseen(
            flown.axis.propeller[1], "the throttle stands still", "steps of the throttle in a manoeuvre"
        )


def _throttle_moves(flown: Flown) -> bool:
    return any(t is not None and np.ptp(t.y) > THROTTLE_MOVES for t in flown.throttle)


def _outputs_said(flown: Flown) -> str:
    """Return the outputs besides the vane's angle in words: ``p, r, φ or the lateral acceleration``."""
    axis = flown.axis
    *symbols, last = (channel(name).symbol for name in axis.outputs if name not in (axis.hidden, axis.force))
    named = [*symbols, last, f"the {axis.readings[axis.force][0]}"] if axis.force else [*symbols, last]
    return " or ".join([", ".join(named[:-1]), named[-1]])


def _propeller(control: str, said: str, sentence: str) -> AxisEffect:
    """Return the propeller's moment at full throttle as the equivalent deflection of a control."""
    entry = f"{control}_rad"
    torque = replace(ARM, effect="thrust_moment", block="moment_equation", names=(entry,), steps=(2e-4,))
    words = dict.fromkeys(without_sizes(THRUST.said, ""), sentence)
    return AxisEffect(THROTTLE, torque, ((THROTTLE, entry),), (0.05,), {**words, "thrust moment": said})
