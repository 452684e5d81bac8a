"""Control surfaces: their servo outputs, and the deflections for given pulse widths.

The deflection is that of the *command*, not of the surface. The estimator models the servo's response.

An output that is not reversed rises with the demand, and a positive pitch demand raises the nose. A longer
pulse moves the trailing edge up, unless the output is reversed. The elevator channel is positive trailing
edge down, hence the minus in `Scale.deflection`.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from advisor.flight.vehicle.mixers import Role
from advisor.process.arrays import FloatArray
from advisor.words.problems import Problem

_FULL_STROKE_RAD = np.radians(25.0)
_UNUSED_PX4 = 900.0


@dataclass(frozen=True, slots=True)
class Scale:
    """Pulses of one output at full travel (taken as 25 degrees) and at zero deflection."""

    low_us: float = 1100.0
    trim_us: float = 1500.0
    high_us: float = 1900.0
    reversed: bool = False

    @property
    def _full_rad(self) -> float:
        """Deflection at ``high_us``, rad."""
        return float(_FULL_STROKE_RAD if self.reversed else -_FULL_STROKE_RAD)

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Return the surface deflection in rad, trailing edge down positive, linear beyond the limits.

        A pulse beyond the limits shows that the limits are assumed, because the autopilot respects its own
        limits.
        """
        away = pwm_us - self.trim_us
        stroke = np.where(away < 0.0, self.trim_us - self.low_us, self.high_us - self.trim_us)
        up = np.divide(away, stroke, out=np.zeros(np.shape(away)), where=stroke > 0.0)
        return np.asarray(self._full_rad * up)


@dataclass(frozen=True, slots=True)
class Calibration:
    """Pairs (PWM in us, deflection in deg) of the aircraft file, with linear interpolation and no
    extrapolation."""

    pairs: tuple[tuple[float, float], ...]

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Return the surface deflection in rad, positive trailing edge down, constant beyond the end
        pairs."""
        pwm, deg = zip(*sorted(self.pairs), strict=True)
        return np.asarray(np.radians(np.interp(pwm_us, pwm, deg)))

    def carried_over(self, measured: Scale, other: Scale) -> "Calibration":
        """Return this calibration for another output of the linkage, relative to TRIM, with the sign of
        REVERSED.
        """
        turn = 1.0 if measured.reversed == other.reversed else -1.0
        moved = ((other.trim_us + turn * (pwm - measured.trim_us), deg) for pwm, deg in self.pairs)
        return Calibration(tuple(sorted(moved)))


@dataclass(frozen=True, slots=True)
class Part:
    """One servo output that moves a surface."""

    output: int
    """Number of the output, from 1 to 32."""
    scale: Scale | Calibration
    share: float = 1.0
    """Share of the output in the surface's deflection. The absolute shares of one surface sum to 1. The share
    is negative for the side that moves the other way on a roll or yaw demand."""
    sure: bool = True
    """Whether a calibration or a parameter gives the output's sign."""
    side: str = ""
    """Outputs of one side respond to one demand, so that each can replace the others. An empty name means a
    side of its own."""

    @property
    def demand(self) -> str:
        """Name of the demand that the output responds to."""
        return self.side or f"output {self.output}"


@dataclass(frozen=True, slots=True)
class Surface:
    """One control surface with its outputs, each with a scale and a share."""

    parts: tuple[Part, ...]
    calibrated: bool
    """Whether the aircraft file has a calibration. Otherwise the parameters' limits and an assumed 25 deg
    give the scale."""
    said: str
    """Sentence for the user about the outputs and their scale."""
    doubts: tuple[Problem, ...] = ()
    """Problems of assumed limits in the scale."""

    @property
    def outputs(self) -> tuple[int, ...]:
        """Numbers of the servo outputs, 1 to 32. Elevons, V-tails, split elevators and stabilators with tabs
        have several outputs."""
        return tuple(part.output for part in self.parts)

    @property
    def scale(self) -> Scale | None:
        """Scale of a single output without a calibration; None for several outputs or a calibrated one."""
        scale = self.parts[0].scale
        return scale if len(self.parts) == 1 and isinstance(scale, Scale) else None

    @property
    def ports(self) -> tuple[int, ...]:
        """Values of SERVO_OUTPUT_RAW.port for the banks that contain the outputs, rising."""
        return tuple(sorted({(n - 1) // 16 for n in self.outputs}))

    @property
    def unsure(self) -> tuple[int, ...]:
        """Outputs with an unknown sign, if there are several. A single output has the sign of the surface."""
        return tuple(part.output for part in self.parts if not part.sure) if len(self.parts) > 1 else ()

    def angles(self, pwm_us: FloatArray) -> FloatArray:
        """Return the angle that each output commands, rad, for pulses; both of shape (n, outputs)."""
        columns = [part.scale.deflection(pwm_us[:, k]) for k, part in enumerate(self.parts)]
        return np.stack(columns, axis=1)

    def combined(self, angles: FloatArray, turned: Iterable[int] = ()) -> FloatArray:
        """Return the surface deflection in rad, shape (n,), from the angles of the outputs.

        Parameters
        ----------
        angles
            Shape (n, number of outputs): angles of the outputs, rad.
        turned
            Outputs to be added with the opposite sign.
        """
        total = np.zeros(len(angles))
        # Column by column, because a product of matrices may round differently for another n.
        for k, part in enumerate(self.parts):
            total += (-part.share if part.output in turned else part.share) * angles[:, k]
        return total

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Return the surface deflection in rad for pulses of shape (n, number of outputs)."""
        return self.combined(self.angles(pwm_us))

    def without(self, silent: Collection[int]) -> "Surface | None":
        """Return the surface with only the outputs that carry a pulse; None if a demand has no output with a
        pulse.
        """
        kept = [part for part in self.parts if part.output not in silent]
        if len(kept) == len(self.parts):
            return self
        if {part.demand for part in kept} != {part.demand for part in self.parts}:
            return None
        muted = joined_numbers([n for n in self.outputs if n in silent])
        has = f"Outputs {muted} carry" if len(self.parts) - len(kept) > 1 else f"Output {muted} carries"
        counts = joined_numbers([part.output for part in kept])
        return replace(
            self,
            parts=_as_before(kept, self.parts),
            said=f"{self.said} {has} no pulse; {counts} alone {'count' if len(kept) > 1 else 'counts'}.",
        )


def _as_before(kept: Sequence[Part], before: Sequence[Part]) -> tuple[Part, ...]:
    """Return the parts with shares rescaled to each demand's earlier share."""

    def total(parts: Iterable[Part], demand: str) -> float:
        return sum(part.share for part in parts if part.demand == demand)

    return tuple(
        replace(part, share=part.share * total(before, part.demand) / total(kept, part.demand))
        for part in kept
    )


def driven(pwm_us: FloatArray, autopilot: str) -> NDArray[np.bool_]:
    """Return which outputs carry a pulse, in the shape of ``pwm_us``. 0, 65535 and NaN mean none; on PX4, 900
    as well."""
    alive = (pwm_us > 0) & (pwm_us < 65535)
    if autopilot == "px4":
        alive &= pwm_us != _UNUSED_PX4
    return alive


def in_shares(parts: Iterable[Part]) -> tuple[Part, ...]:
    """Return the parts of one surface, sorted by output, with absolute shares that sum to 1."""
    ordered = sorted(parts, key=lambda part: part.output)
    total = sum(abs(part.share) for part in ordered)
    return tuple(replace(part, share=part.share / total) for part in ordered)


def joined_numbers(outputs: Sequence[int]) -> str:
    """Return numbers as a list in words: ``1``, ``1 and 2``, ``1, 2 and 3``."""
    return listed([str(n) for n in outputs])


def listed(words: Sequence[str]) -> str:
    """Return words as a list in a sentence: ``a``, ``a and b``, ``a, b and c``."""
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


Names = tuple[str, str, str]
"""Names of the parameters of the pulses at one full deflection, at zero, and at the other full deflection."""


_GIVE = "give the output a calibration in the aircraft file"
_RECORD = f"Record the vehicle's parameters, or {_GIVE}."


def limits(names: Names, stated: Mapping[str, float], usual: Scale) -> tuple[Scale, Problem | None]:
    """Return the scale of an output, and the problem of its assumed limits; None if all are stated."""
    heard = [stated.get(name) for name in names]
    wrong = _contradiction(names, heard)
    if wrong:
        assumed = f"{usual.low_us:g}, {usual.trim_us:g} and {usual.high_us:g} us"
        return usual, Problem(
            "servo_limits",
            f"{wrong}; {assumed} are assumed.",
            f"Set {names[0]}, {names[1]} and {names[2]} to rising pulses, or {_GIVE}.",
        )
    scale = _completed(heard, usual)
    absent = [
        f"{name} {value:g}"
        for name, given, value in zip(names, heard, (scale.low_us, scale.trim_us, scale.high_us), strict=True)
        if given is None
    ]
    if not absent:
        return scale, None
    are = "are" if len(absent) > 1 else "is"
    return scale, Problem(
        "servo_limits",
        f"{listed(absent)} {are} assumed, because no parameter states {'them' if len(absent) > 1 else 'it'}.",
        _RECORD,
    )


def assumed_limits(output: int, scale: Scale) -> Problem:
    """Return the problem of an output whose scale is assumed."""
    return Problem(
        "servo_limits",
        f"Pulses of {scale.low_us:g}, {scale.trim_us:g} and {scale.high_us:g} us are assumed for output "
        f"{output}, because no parameter states its limits.",
        _RECORD,
    )


def _contradiction(names: Names, heard: list[float | None]) -> str:
    """Return the reason in words why no linkage can have the stated limits; empty for possible limits."""
    given = [(name, value) for name, value in zip(names, heard, strict=True) if value is not None]
    for name, value in given:
        if value <= 0.0:
            return f"{name} is {value:g}, which is no pulse"
    # The outermost pair comes first: it names limits that are swapped.
    for (lower, low), (upper, high) in [*zip(given[:1], given[-1:], strict=True), *pairwise(given)]:
        if low > high:
            return f"{lower} {low:g} is above {upper} {high:g}"
    if len(given) > 1 and given[0][1] == given[-1][1]:
        return (
            f"{given[0][0]} and {given[-1][0]} are both {given[0][1]:g}, which leaves the surface no travel"
        )
    return ""


def _completed(heard: list[float | None], usual: Scale) -> Scale:
    """Return the stated limits, completed by usual ones on the right side of zero."""
    given = [value for value in heard if value is not None]
    low, trim, high = heard
    low = min([usual.low_us, *given]) if low is None else low
    high = max([usual.high_us, *given]) if high is None else high
    if trim is None:
        trim = usual.trim_us if low < usual.trim_us < high else 0.5 * (low + high)
    return Scale(low, trim, high, usual.reversed)


Parameters = Mapping[str, float]
"""Value of each of the vehicle's parameters, by its name."""


@dataclass(frozen=True, slots=True)
class Words:
    """Names of the servo output parameters in an autopilot's terms."""

    function: str
    """Name of the parameter for the surface that an output moves."""
    elevator: str
    """Parameter setting that makes an output the elevator."""
    limits: str
    """Names of the parameters of the pulses at full travel."""
    trim: str
    """Name of the parameter of the pulse at zero deflection."""
    sense: str
    """Name of the parameter of an output's direction; ``{n}`` stands for its number."""
    unknown: str
    """Sentence with the reason why no output is the elevator."""
    usual: str
    """Usual output of the elevator."""


@dataclass(frozen=True, slots=True)
class Wiring:
    """Known roles, scales and directions of the servo outputs."""

    words: Words
    roles: Mapping[int, Role] = field(default_factory=dict)
    """Role of each output, if known, by the output's number from 1. Outputs without a surface have a role
    without a name."""
    scales: Mapping[int, Scale] = field(default_factory=dict)
    known_directions: frozenset[int] = frozenset()
    """Outputs whose direction the parameters give."""
    assumed: str = ""
    """Sentence about guesses among the roles."""
    doubts: Mapping[int, Problem] = field(default_factory=dict)
    """Problem of each output with assumed limits, by the output's number."""
    passed: Mapping[int, int] = field(default_factory=dict)
    """Radio channel that each output passes through without a mixer, by the output's number."""

    def scale(self, n: int) -> Scale:
        """Return the scale of output ``n``, with ArduPilot's defaults for unknown parameters."""
        return self.scales.get(n, Scale())

    def limits_problem(self, n: int) -> Problem | None:
        """Return the problem of the assumed limits of output ``n``; None where parameters state them."""
        if n in self.scales:
            return self.doubts.get(n)
        return assumed_limits(n, self.scale(n))
