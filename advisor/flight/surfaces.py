"""Control surfaces: which servo outputs move one, and what their pulse widths mean.

The deflection is that of the *command*; what the servo makes of it is the estimator's business.

Signs: an output that is not reversed rises with the demand, and a positive pitch demand lifts
the nose; so more PWM is trailing edge up unless the output is reversed. The elevator channel
counts trailing edge down as positive, hence the minus in `Scale.deflection`.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from advisor.flight.messages import FloatArray

_FULL_STROKE_RAD = np.radians(25.0)
_UNUSED_PX4 = 900.0


@dataclass(frozen=True, slots=True)
class Scale:
    """Pulses of one output's full strokes, taken as 25 degrees, and of no deflection."""

    low_us: float = 1100.0
    trim_us: float = 1500.0
    high_us: float = 1900.0
    reversed: bool = False

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Return the surface angle in rad, trailing edge down positive, clipped at the ends."""
        up = np.interp(pwm_us, [self.low_us, self.trim_us, self.high_us], [-1.0, 0.0, 1.0])
        return np.asarray((_FULL_STROKE_RAD if self.reversed else -_FULL_STROKE_RAD) * up)


@dataclass(frozen=True, slots=True)
class Calibration:
    """Pairs (PWM in us, deflection in deg) of the aircraft file, linear between, none beyond."""

    pairs: tuple[tuple[float, float], ...]

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Return the surface angle in rad, trailing edge down positive, held at the last pair beyond the
        ends."""
        pwm, deg = zip(*sorted(self.pairs), strict=True)
        return np.asarray(np.radians(np.interp(pwm_us, pwm, deg)))

    def carried_over(self, measured: Scale, other: Scale) -> "Calibration":
        """Return this calibration for an output of the same linkage: counted from TRIM, turned by REVERSED.

        Parameters
        ----------
        measured
            Of the output that the calibration belongs to.
        other
            Of the output that it is carried over to.
        """
        turn = 1.0 if measured.reversed == other.reversed else -1.0
        moved = ((other.trim_us + turn * (pwm - measured.trim_us), deg) for pwm, deg in self.pairs)
        return Calibration(tuple(sorted(moved)))


@dataclass(frozen=True, slots=True)
class Part:
    """One servo output that moves a surface."""

    output: int
    """1..32."""
    scale: Scale | Calibration
    share: float = 1.0
    """Of the surface's deflection; the shares of one surface sum to 1."""
    sure: bool = True
    """Whether a calibration or the parameters say which way the output counts."""


@dataclass(frozen=True, slots=True)
class Surface:
    """One control surface: the outputs that drive it, each with its scale and its share."""

    parts: tuple[Part, ...]
    calibrated: bool
    """False when the scale is the limits in the parameters and an assumed 25 deg."""
    said: str
    """What the user should know about this mapping."""

    @property
    def outputs(self) -> tuple[int, ...]:
        """Servo outputs 1..32; several for elevons, a V-tail, a split elevator, a stabilator with a tab."""
        return tuple(part.output for part in self.parts)

    @property
    def ports(self) -> tuple[int, ...]:
        """SERVO_OUTPUT_RAW.port of the banks of 16 that hold the outputs, rising."""
        return tuple(sorted({(n - 1) // 16 for n in self.outputs}))

    @property
    def unsure(self) -> tuple[int, ...]:
        """Outputs of several that nothing tells the sense of; a single one's is the surface's."""
        return tuple(part.output for part in self.parts if not part.sure) if len(self.parts) > 1 else ()

    def angles(self, pwm_us: FloatArray) -> FloatArray:
        """What each output commands, rad, from pulses; both of shape (n, number of outputs)."""
        columns = [part.scale.deflection(pwm_us[:, k]) for k, part in enumerate(self.parts)]
        return np.stack(columns, axis=1)

    def combined(self, angles: FloatArray, turned: Iterable[int] = ()) -> FloatArray:
        """Return the surface angle in rad, shape (n,), from what each output commands.

        Parameters
        ----------
        angles
            Shape (n, number of outputs), rad.
        turned
            Outputs that count the other way.
        """
        total = np.zeros(len(angles))
        # Column by column, for a product of matrices may round otherwise for another n.
        for k, part in enumerate(self.parts):
            total += (-part.share if part.output in turned else part.share) * angles[:, k]
        return total

    def deflection(self, pwm_us: FloatArray) -> FloatArray:
        """Return the surface angle in rad from pulses of shape (n, number of outputs)."""
        return self.combined(self.angles(pwm_us))


def driven(pwm_us: FloatArray, autopilot: str) -> NDArray[np.bool_]:
    """Return rows in which every output carries a pulse: 0, 65535 and NaN mean none, on PX4 900 too."""
    alive = (pwm_us > 0) & (pwm_us < 65535)
    if autopilot == "px4":
        alive &= pwm_us != _UNUSED_PX4
    return np.asarray(np.all(alive, axis=1))


def in_shares(parts: Iterable[Part]) -> tuple[Part, ...]:
    """Return the parts of one surface, in the order of their outputs, with shares that sum to 1."""
    ordered = sorted(parts, key=lambda part: part.output)
    total = sum(part.share for part in ordered)
    return tuple(replace(part, share=part.share / total) for part in ordered)


def joined_numbers(outputs: Sequence[int]) -> str:
    """Return outputs as a sentence lists them: ``1``, ``1 and 2``, ``1, 2 and 3``."""
    return listed([str(n) for n in outputs])


def listed(words: Sequence[str]) -> str:
    """Return words as a sentence lists them."""
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))
