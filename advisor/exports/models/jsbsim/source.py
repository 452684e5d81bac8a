"""Text of a JSBSim aircraft: parsed, written with added functions and a servo, and run.

A lift term also changes the pitching moment by its arm, and a side force acts on roll and yaw. The aircraft
is therefore corrected and measured repeatedly until each derivative has its target value.
"""

import json
import math
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypeVar

from advisor.exports.models.improvement import ExportedServo, xml_comment
from advisor.exports.models.jsbsim.slopes import Request, SideSlopes, Slopes
from advisor.process.children import python_module
from advisor.simulators.jsbsim_model import find_model, foreign_properties
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


TIME_LIMIT_S = 60.0
"""Time limit for loading and measuring one aircraft, s. Normally less than a second is needed."""


@dataclass(frozen=True)
class Model:
    """Location of a JSBSim aircraft and of the files that it needs."""

    file: Path
    engine: Path
    systems: Path

    @property
    def name(self) -> str:
        """Name of the aircraft in JSBSim, which is that of its file."""
        return self.file.stem


def model_of(what: str) -> Model:
    """Return the aircraft that ``jsbsim:`` names, with engines and systems of its JSBSim tree, if any.

    Raises
    ------
    ConfigurationError
        JSBSim is not installed, or has no such aircraft.
    """
    file = find_model(what)
    import jsbsim

    shipped = Path(jsbsim.get_default_root_dir())
    own = file.parents[:3]
    engine, systems = (
        next((up / name for up in own if (up / name).is_dir()), shipped / name)
        for name in ("engine", "systems")
    )
    return Model(file, engine, systems)


def measure(content: bytes, model: Model, asked: Request) -> Slopes:
    """Return the short-period slopes of an aircraft text, loaded in place of the aircraft.

    Raises
    ------
    ConfigurationError
        Errors as for ``_answered``.
    """
    return Slopes(**_answered(content, model, asdict(asked)))


def measure_side(content: bytes, model: Model, asked: Request) -> SideSlopes:
    """Return the roll and yaw slopes of an aircraft text, loaded in place of the aircraft.

    Raises
    ------
    ConfigurationError
        Errors as for ``_answered``.
    """
    return SideSlopes(**_answered(content, model, asdict(asked)))


def _answered(content: bytes, model: Model, asked: dict[str, Any]) -> dict[str, Any]:
    """Load an aircraft text with its included files, and return its measurement."""
    root = parse(content, model.file.name)
    for tag in ("input", "output"):
        # Sockets and files that the aircraft would open.
        for element in root.findall(tag):
            root.remove(element)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / model.name
        place.mkdir()
        for entry in model.file.parent.iterdir():
            if entry.name != f"{model.name}.xml":
                (place / entry.name).symlink_to(entry)
        ET.ElementTree(root).write(place / f"{model.name}.xml", encoding="utf-8")
        places = {"aircraft": folder, "engine": str(model.engine), "systems": str(model.systems)}
        foreign = list(foreign_properties([root]))
        request = asked | places | {"model": model.name, "foreign": foreign}
        try:
            done = subprocess.run(
                python_module("advisor.exports.models.jsbsim.slopes"),
                input=json.dumps(request), capture_output=True, text=True, timeout=TIME_LIMIT_S, check=True,
                cwd=folder, env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            )  # fmt: skip
            answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
            return answer
        except (subprocess.SubprocessError, ValueError, IndexError, TypeError) as error:
            raise ConfigurationError(
                f"--export jsbsim: JSBSim does not load and trim {model.file.name} at "
                f"{asked['airspeed_m_s']:.4g} m/s; check the aircraft, and the air speed of the log."
            ) from error
