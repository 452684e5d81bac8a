"""The response of either grid, chosen by the type of the grid when a kernel is compiled.

One search then serves the closed form of the short period and the kernel of any axis.
"""

from collections.abc import Callable
from typing import Any

from numba.extending import overload

from advisor.flight.signals.messages import FloatArray
from advisor.model.axis_response import AxisGrid, respond_axis
from advisor.model.response import Grid, respond


def respond_either(
    grid: Grid | AxisGrid, shared: FloatArray, local: FloatArray, y: FloatArray, g: FloatArray
) -> bool:
    """Solve the model of a grid, as ``respond`` and ``respond_axis`` do."""
    if isinstance(grid, Grid):
        return bool(respond(grid, shared, local, y, g))
    return bool(respond_axis(grid, shared, local, y, g))


@overload(respond_either)
def _compiled(grid: Any, shared: Any, local: Any, y: Any, g: Any) -> Callable[..., Any]:
    """Return the function that numba compiles for the type of ``grid``."""
    return _short_period if grid.instance_class is Grid else _axis


def _short_period(grid: Any, shared: Any, local: Any, y: Any, g: Any) -> Any:
    return respond(grid, shared, local, y, g)


def _axis(grid: Any, shared: Any, local: Any, y: Any, g: Any) -> Any:
    return respond_axis(grid, shared, local, y, g)
