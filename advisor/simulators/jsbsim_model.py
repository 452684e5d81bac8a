"""A JSBSim aircraft from a changed copy of its XML, which accepts increments and a directly set elevator.

The copy is in a temporary folder; nothing is written next to the model. The copy has an external force and
moment for increments, and a point mass for the flown mass. A last channel of the copy's flight control can
set the elevator. The copy has no <output> and no <input>, so the model opens neither files nor sockets.

A property that only another program writes, such as FlightGear, gets the value 0. JSBSim would abort on an
unknown property.
"""

import importlib.util
import os
import re
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from advisor.words.problems import ConfigurationError, UnusableInputError

_OWN = (
    "accelerations", "aero", "ap-internal", "atmosphere", "attitude", "buoyant_forces", "contact",
    "external_reactions", "fcs", "flight-path", "forces", "gear", "ground", "hydro", "ic", "inertia",
    "inertial", "metrics", "moments", "orbital", "position", "propulsion", "simulation", "tank", "velocities",
)  # fmt: skip
"""First parts of the names of JSBSim's own properties."""
_SECTIONS = frozenset({"system", "autopilot", "flight_control", "aerodynamics", "channel", "metrics"})
"""XML elements whose ``property`` attribute is a declaration."""
_PROSE = frozenset({"description", "documentation", "note", "reference", "fileheader", "tableData"})
"""XML elements whose text is not a property."""
_NAME = re.compile(r"(?<![\w/.-])-?(/?[A-Za-z_][\w.\[\]-]*(?:/[A-Za-z_][\w.\[\]-]*)+)")


def foreign_properties(roots: Iterable[ET.Element]) -> tuple[str, ...]:
    """Return the properties that a model reads but that neither the model nor JSBSim defines."""
    read: dict[str, None] = {}
    written: set[str] = set()
    for root in roots:
        for parent, element in _without_prose(root, root):
            text = element.text or ""
            named = element.get("name", "")
            if named:
                # JSBSim makes this property from a component's name.
                written.update((named, f"fcs/{named.strip().lower().replace(' ', '-')}"))
            if element.tag == "output" or (element.tag == "property" and parent.tag in _SECTIONS):
                written.add(text.strip())
                continue
            values = [text, *(v for k, v in element.attrib.items() if k == "value")]
            read.update((name, None) for value in values for name in _NAME.findall(value))
    return tuple(name for name in read if name not in written and name.lstrip("/").split("/")[0] not in _OWN)


def _without_prose(parent: ET.Element, element: ET.Element) -> Iterator[tuple[ET.Element, ET.Element]]:
    if element.tag in _PROSE:
        return
    yield parent, element
    for child in element:
        yield from _without_prose(element, child)


FORCE = "external_reactions/advisor-force"
AXIAL = "external_reactions/advisor-axial"
MOMENT = "external_reactions/advisor-moment/magnitude-lbsft"
WRITES = "advisor/elevator-writes"
"""Property that is 1 if the elevator's surface is set directly and the model's flight control is bypassed."""
WRITTEN = "advisor/elevator-written-rad"
LOAD = "inertia/pointmass-weight-lbs"
LOAD_PLACE = "inertia/pointmass-location-{}-inches"


def find_model(name: str) -> Path:
    """Return the XML file of a model that JSBSim ships, or of the user's path.

    Raises
    ------
    ConfigurationError
        JSBSim is not installed or has no such model, or the path is no file.
    """
    if name.endswith(".xml") or os.sep in name or "/" in name:
        path = Path(name)
        if not path.is_file():
            fix = "Give the path of the model's XML."
            raise UnusableInputError("no_such_file", f"There is no file {name}.", fix)
        return path.resolve()
    package = importlib.util.find_spec("jsbsim")
    if package is None or package.origin is None:
        raise ConfigurationError("jsbsim is not installed: pip install 'inflight-advisor[jsbsim]'.")
    shipped = Path(package.origin).parent / "aircraft"
    path = shipped / name / f"{name}.xml"
    if not name or not path.is_file():
        names = sorted(path.name for path in shipped.iterdir() if (path / f"{path.name}.xml").is_file())
        near = get_close_matches(name, names, 1)
        hint = f"did you mean {near[0]}" if near else "c172p and 737 are two of its models"
        raise ConfigurationError(f"jsbsim: JSBSim has no model {name!r}; {hint}, or a path to model.xml.")
    return path


def load(path: Path, dt: float) -> tuple[Any, tuple[str, ...]]:
    """Return JSBSim with the model, and the names of other programs' properties, set to 0.

    ``dt`` is the time step, s.

    Raises
    ------
    UnusableInputError
        The file is no JSBSim model, or JSBSim does not load the model.
    """
    os.environ["JSBSIM_DEBUG"] = "0"
    import jsbsim

    root = Path(jsbsim.get_default_root_dir())
    # An aircraft of a whole JSBSim tree has its engines and systems two folders up.
    own = path.parent.parent.parent
    engines, systems = (
        str(folder if folder.is_dir() else root / folder.name) for folder in (own / "engine", own / "systems")
    )
    tree = _equipped(path)
    foreign = foreign_properties(_files(tree, [path.parent, path.parent / "Systems", Path(systems)]))
    fdm = jsbsim.FGFDMExec(str(root))
    fdm.set_debug_level(0)
    # A lag or filter computes its coefficients from the step at the time of loading.
    fdm.set_dt(dt)
    for name in foreign:
        fdm[name] = 0.0
    # JSBSim finds the copy by way of the model's folder. Beyond a link, ".." leads elsewhere.
    folder = path.parent.resolve()
    with tempfile.TemporaryDirectory() as made:
        copy = Path(made).resolve() / path.stem
        tree.write(copy.with_name(f"{path.stem}.xml"))
        try:
            relative = os.path.relpath(copy, folder)
            loaded = fdm.load_model_with_paths(relative, str(folder), engines, systems, False)
        except jsbsim.BaseError as error:
            raise _unloadable(path, " ".join(str(error).split())) from error
    if not loaded:
        raise _unloadable(path, "JSBSim does not load the file")
    return fdm, foreign


def _unloadable(path: Path, why: str) -> UnusableInputError:
    return UnusableInputError(
        "simulator_model",
        f"{path.name} does not load as a JSBSim aircraft: {why[:300].rstrip('. ')}.",
        "Load the file in JSBSim itself, and fix what JSBSim reports.",
    )


def _equipped(path: Path) -> "ET.ElementTree[ET.Element]":
    try:
        tree = ET.parse(path)
    except (ET.ParseError, OSError, UnicodeError) as error:
        raise _unloadable(path, str(error)) from error
    root = tree.getroot()
    if root is None or root.tag != "fdm_config":
        raise _unloadable(path, "its outermost element is not <fdm_config>")
    for tag in ("output", "input"):
        for element in root.findall(tag):
            root.remove(element)
    # The first point mass keeps the index 0, whatever the model's own are.
    _section(root, "mass_balance").insert(0, ET.fromstring(_POINT_MASS))
    _section(root, "flight_control", path.parent).extend(ET.fromstring(_CHANNEL))
    _section(root, "external_reactions").extend(ET.fromstring(_REACTIONS))
    return tree


def _files(tree: "ET.ElementTree[ET.Element]", folders: Sequence[Path]) -> list[ET.Element]:
    """Return the root elements of a model's file and of its included systems."""
    root = tree.getroot()
    assert root is not None
    roots = [root]
    for element in root.iter():
        name = element.get("file", "").removesuffix(".xml")
        file = (
            next((f for folder in folders if (f := folder / f"{name}.xml").is_file()), None) if name else None
        )
        if file is not None and element.tag in ("system", "autopilot", "flight_control", "aerodynamics"):
            with suppress(ET.ParseError):
                roots.append(ET.parse(file).getroot())
    return roots


def _section(root: ET.Element, tag: str, folder: Path | None = None) -> ET.Element:
    """Return the section with the content of its own ``file``; a missing section is created."""
    section = root.find(tag)
    if section is None:
        section = ET.SubElement(root, tag, {"name": "advisor"})
    elsewhere = section.get("file")
    if elsewhere and folder is not None:
        file = folder / (elsewhere if elsewhere.endswith(".xml") else f"{elsewhere}.xml")
        if file.is_file():
            section.attrib.pop("file")
            section.extend(ET.parse(file).getroot())
    return section


_POINT_MASS = """<pointmass name="advisor"><weight unit="LBS">0</weight>
<location unit="IN"><x>0</x><y>0</y><z>0</z></location></pointmass>"""

_CHANNEL = f"""<channels>
<property value="0">{WRITES}</property>
<property value="0">{WRITTEN}</property>
<channel name="advisor"><switch name="advisor/elevator">
<default value="fcs/elevator-pos-rad"/><test value="{WRITTEN}">{WRITES} == 1</test>
<output>fcs/elevator-pos-rad</output></switch></channel></channels>"""

_REACTIONS = """<reactions>
<force name="advisor-force" frame="WIND"><location unit="IN"><x>0</x><y>0</y><z>0</z></location>
<direction><x>0</x><y>0</y><z>1</z></direction></force>
<force name="advisor-axial" frame="WIND"><location unit="IN"><x>0</x><y>0</y><z>0</z></location>
<direction><x>1</x><y>0</y><z>0</z></direction></force>
<moment name="advisor-moment" frame="BODY"><direction><x>0</x><y>1</y><z>0</z></direction></moment>
</reactions>"""
