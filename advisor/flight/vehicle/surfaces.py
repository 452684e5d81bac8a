"""Control surfaces: their servo outputs, and the deflections for given pulse widths.

The deflection is that of the *command*, not of the surface. The estimator models the servo's response.

An output that is not reversed rises with the demand, and a positive pitch demand raises the nose. A longer
pulse moves the trailing edge up, unless the output is reversed. The elevator channel is positive trailing
edge down, hence the minus in `Scale.deflection`.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

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
