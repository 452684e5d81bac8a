"""Roles, travels, limits and directions of servo outputs, from an autopilot's parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

from advisor.flight.vehicle.mixers import Role
from advisor.flight.vehicle.surfaces import Scale, listed
from advisor.words.problems import Problem

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
