"""Text of a JSBSim aircraft: parsed, and written with added functions and a servo.

A lift term also changes the pitching moment by its arm, and a side force acts on roll and yaw. The aircraft
is therefore corrected and measured repeatedly until each derivative has its target value.
"""

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from advisor.exports.models.improvement import ExportedServo, xml_comment
from advisor.exports.models.jsbsim.slopes import SideSlopes, Slopes
from advisor.words.problems import ConfigurationError

_ELEVATOR = re.compile(r"fcs/elevator-pos-(rad|deg|norm)")
AXES = {"Z": "LIFT", "M": "PITCH"}
SURFACES = {"fcs/elevator-pos-rad": 1.0, "fcs/elevator-pos-deg": 57.29577951308232}
"""Number of units per radian of each surface property. The normalised position from -1 to 1 has no such
number."""
PLAIN = {"alpha": "aero/alpha-rad", "q": "velocities/q-aero-rad_sec", "delta_e": "fcs/elevator-pos-rad"}


@dataclass(frozen=True)
class AddedFunction:
    """A function that is added to an axis: dynamic pressure times a power of one variable."""

    name: str
    axis: str
    value: float
    """Value of the function for a dynamic pressure of 1 psf and a power of 1, lbs or lbs·ft."""
    property: str
    about: float = 0.0
    """Value of the property at which the variable is zero."""
    power: int = 1
    further: str = ""
    """Further property of JSBSim that multiplies the function of a force or moment."""


def parse(content: bytes, name: str) -> ET.Element:
    """Return the XML tree of a JSBSim aircraft, with its comments.

    Raises
    ------
    ConfigurationError
        The content is no XML, or no JSBSim aircraft with LIFT and PITCH.
    """
    try:
        root = ET.fromstring(content, ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    except ET.ParseError as error:
        raise ConfigurationError(
            f"--export jsbsim: {name} is no XML ({error}); name a JSBSim aircraft."
        ) from (error)
    axes = {axis.get("name") for axis in root.iterfind("aerodynamics/axis")}
    if root.tag != "fdm_config" or not set(AXES.values()) <= axes:
        raise ConfigurationError(
            f"--export jsbsim: {name} has no aerodynamics with the axes LIFT and PITCH; "
            "use --export matlab or aircraft."
        )
    return root


def surface_of(root: ET.Element) -> str:
    """Return the elevator's position property on which the pitching moment depends."""
    for axis in root.iterfind("aerodynamics/axis[@name='PITCH']"):
        for element in axis.iter():
            text = (element.text or "").strip().removeprefix("-")
            if element.tag in ("property", "p", "independentVar") and _ELEVATOR.fullmatch(text):
                return text
    return "fcs/elevator-pos-rad"


def corrected(
    content: bytes, name: str, added: Sequence[AddedFunction], servo: ExportedServo, note: str
) -> str:
    """Return the aircraft's text with added functions, and with the servo after the elevator's command.

    Raises
    ------
    ConfigurationError
        The content is no aircraft (see ``parse``), or the model's elevator position is no angle.
    """
    root = parse(content, name)
    for function in added:
        axis = next(a for a in root.iterfind("aerodynamics/axis") if a.get("name") == function.axis)
        axis.append(_function(function))
    if not servo.is_quick:
        _insert(servo, root)
    prolog = content.split(b"<fdm_config")[0].decode("utf-8", "replace")
    comments = re.findall(r"<!--.*?-->", prolog, re.DOTALL)
    head = ['<?xml version="1.0" encoding="utf-8"?>', *comments, xml_comment(note)]
    return "\n".join([*head, ET.tostring(root, encoding="unicode")]) + "\n"


def _function(added: AddedFunction) -> ET.Element:
    function = ET.Element("function", {"name": f"aero/advisor/{added.name}"})
    function.append(_element("description", f"advisor gap: {added.name} as flown"))
    product = ET.SubElement(function, "product")
    product.append(_element("value", f"{added.value:.8g}"))
    for name in ("aero/qbar-psf", added.further):
        if name:
            product.append(_element("property", name))
    raised = ET.SubElement(product, "pow")
    departure = ET.SubElement(raised, "difference")
    departure.append(_element("property", added.property))
    departure.append(_element("value", f"{added.about:.8g}"))
    raised.append(_element("value", str(added.power)))
    return function


def _insert(servo: ExportedServo, root: ET.Element) -> None:
    """Add JSBSim's actuator in a separate channel, after all components that move the elevator."""
    surface = surface_of(root)
    unit = SURFACES.get(surface)
    bounded = servo.rate_rad_s or servo.play_rad or servo.deadband_rad
    if unit is None and bounded:
        raise ConfigurationError(
            f"--export jsbsim: the model moves by {surface}, which is no angle: rate limit, backlash and "
            "dead band cannot be given; let its moment depend on fcs/elevator-pos-rad."
        )
    control = root.find("flight_control")
    if control is None:
        control = ET.SubElement(root, "flight_control", {"name": "FCS"})
    channel = ET.SubElement(control, "channel", {"name": "Elevator as flown"})
    scale, commanded = unit or 1.0, surface
    lag_s = servo.lag_s
    if servo.damping and lag_s > 0.0:
        # JSBSim's trim passes through actuators but not through filters of second order, hence two lags in a
        # row.
        lag_s *= 0.5
        commanded = "fcs/advisor/elevator-lagged"
        first = ET.SubElement(channel, "actuator", {"name": commanded})
        first.append(_element("input", surface))
        first.append(_element("lag", f"{1.0 / lag_s:.8g}"))
    actuator = ET.SubElement(channel, "actuator", {"name": "fcs/advisor/elevator-servo"})
    actuator.append(_element("input", commanded))
    numbers = {
        "lag": 1.0 / lag_s if lag_s > 0.0 else 0.0,
        "rate_limit": scale * (servo.rate_rad_s or 0.0),
        "deadband_width": scale * servo.deadband_rad,
        "hysteresis_width": scale * servo.play_rad,
        "delay": servo.delay_s,
    }
    for tag, number in numbers.items():
        if number > 0.0:
            actuator.append(_element(tag, f"{number:.8g}"))
    actuator.append(_element("output", surface))


def _element(tag: str, text: str) -> ET.Element:
    element = ET.Element(tag)
    element.text = text
    return element


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
