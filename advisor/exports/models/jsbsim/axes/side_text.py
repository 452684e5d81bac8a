"""Copy of the user's JSBSim aircraft with the flown roll and yaw derivatives.

A derivative is corrected if the 95 % interval of the estimate excludes the aircraft's value. The difference
is added as a function of β, p, r, aileron or rudder. Each function is proportional to the dynamic pressure,
and for p or r also to b/(2·V). With neutral controls such a function changes no trim.
"""

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from functools import partial
from math import isfinite

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.exports.models.flown import SideModel
from advisor.exports.models.improvement import Exported, ExportedServo, zero_said
from advisor.exports.models.jsbsim.slopes import SIDE_VARIABLES as VARIABLES
from advisor.exports.models.jsbsim.slopes import Request, SideSlopes
from advisor.exports.models.jsbsim.source import AddedFunction, Model, corrected, measure_side, parse, settled
from advisor.words.problems import ConfigurationError

RATES = ("p", "r")
AXES = {"Y": "SIDE", "L": "ROLL", "N": "YAW"}


def side_text(name: str, side: SideModel, model: Model, content: bytes) -> Exported:
    """Return the corrected aircraft, measured at the flown speed and height.

    Parameters
    ----------
    content
        Text of the aircraft, with pitch possibly corrected already.

    Raises
    ------
    ConfigurationError
        The aircraft does not load or trim, has no axes of side force, roll and yaw, or its aileron or rudder
        moves nothing.
    """
    _require_axes(parse(content, model.file.name), model.file.name)
    speed = side.true_airspeed_m_s
    asked = Request(speed, side.air.height_m or 0.0, powered=False, sideways=True)
    first = measure_side(content, model, asked)
    wanted = _targets(side, first)

    def measured(added: Sequence[AddedFunction]) -> SideSlopes:
        made = corrected(content, model.file.name, added, ExportedServo(), "")
        return measure_side(made.encode(), model, asked)

    changes, _ = settled(first, wanted, partial(_loads, own=first), _functions, measured)
    changed = [name for name in SIDE_PARAMETERS if wanted[name] != first.derivatives[name]]
    note = (
        f"Corrected by the inflight advisor for {name} at {speed:.4g} m/s: {', '.join(changed) or 'nothing'}."
    )
    left = [f"{p}: {reason}" for p, reason in side.untold.items()]
    left += [zero_said(p) for p in side.zeros if p in changed]
    left += [f"the {n}'s servo ({', '.join(s.lines())})" for n, s in side.servos.items() if s.lines()]
    return Exported(corrected(content, model.file.name, changes, ExportedServo(), note), tuple(left))


def _require_axes(root: ET.Element, name: str) -> None:
    missing = set(AXES.values()) - {axis.get("name") for axis in root.iterfind("aerodynamics/axis")}
    if missing:
        raise ConfigurationError(
            f"--export jsbsim: {name} has no axis {', '.join(sorted(missing))}; use --export matlab."
        )


def _targets(side: SideModel, own: SideSlopes) -> dict[str, float]:
    """Return the target of each derivative, per unit of the aircraft's properties."""
    wanted = dict(own.derivatives)
    for name, value in side.values.items():
        sign = own.signs.get(name[2:], 1.0)
        if isfinite(side.half(name)) and abs(sign * value.value - wanted[name]) > side.half(name):
            wanted[name] = sign * side.number(name)
    return wanted


def _loads(missing: Mapping[str, float], own: SideSlopes) -> dict[str, float]:
    """Return the value of each derivative's additional function, lbs or lbs·ft."""
    moments = np.linalg.inv(np.array(own.turning))
    loads: dict[str, float] = {}
    for variable in VARIABLES:
        roll, yaw = moments @ [missing[f"L_{variable}"], missing[f"N_{variable}"]]
        needed = {"Y": own.momentum * missing[f"Y_{variable}"], "L": roll, "N": yaw}
        scale = own.pressure_psf * (own.span_time_s if variable in RATES else 1.0)
        loads |= {f"{y}_{variable}": float(size / scale) for y, size in needed.items()}
    return loads


def _functions(sizes: Mapping[str, float]) -> list[AddedFunction]:
    return [
        AddedFunction(
            name, AXES[name[0]], size, VARIABLES[name[2:]], further="aero/bi2vel" if name[2:] in RATES else ""
        )
        for name, size in sizes.items()
        if size
    ]
