"""Search for the added functions with which an aircraft has given derivatives, on any axis.

A lift term also changes the pitching moment by its arm, and a side force acts on roll and yaw. The aircraft
is corrected and measured repeatedly until each derivative has its target value.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from advisor.exports.models.jsbsim.slopes import SideSlopes, Slopes
from advisor.exports.models.jsbsim.source import AddedFunction
from advisor.words.problems import ConfigurationError

_ROUNDS = 8
"""Largest number of rounds. Each round divides the derivatives' error by ten or more."""
_RELATIVE, _ABSOLUTE = 1e-3, 1e-4
"""Error of a derivative below which the search has converged: relative, and absolute in SI units."""
S = TypeVar("S", Slopes, SideSlopes)


def settled(
    first: S,
    targets: Mapping[str, float],
    loads: Callable[[Mapping[str, float]], Mapping[str, float]],
    functions: Callable[[Mapping[str, float]], Sequence[AddedFunction]],
    measured: Callable[[Sequence[AddedFunction]], S],
) -> tuple[Sequence[AddedFunction], S]:
    """Return the added functions with which an aircraft has its targets, and its slopes with them.

    Parameters
    ----------
    first
        Slopes of the aircraft as it is.
    loads
        Function from changes of derivatives to the values of their functions, lbs or lbs·ft.

    Raises
    ------
    ConfigurationError
        A derivative misses its target.
    """
    sizes, now = dict.fromkeys(targets, 0.0), first
    for _ in range(_ROUNDS):
        missing = {name: target - now.derivatives[name] for name, target in targets.items()}
        off = [
            name for name, target in targets.items()
            if not math.isclose(now.derivatives[name], target, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)
        ]  # fmt: skip
        if not off:
            return functions(sizes), now
        change = loads(missing)
        sizes = {name: size + change[name] for name, size in sizes.items()}
        now = measured(functions(sizes))
    raise ConfigurationError(
        f"--export jsbsim: the aircraft cannot be given {off[0]} = {targets[off[0]]:.4g}; "
        "use --export matlab or aircraft."
    )
