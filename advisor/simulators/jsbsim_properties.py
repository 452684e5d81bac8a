"""Properties that a JSBSim model reads and that only another program, such as FlightGear, writes.

JSBSim ends on a property that does not exist. These get the value 0, as in a FlightGear that has not begun.
"""

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator

_OWN = (
    "accelerations", "aero", "ap-internal", "atmosphere", "attitude", "buoyant_forces", "contact",
    "external_reactions", "fcs", "flight-path", "forces", "gear", "ground", "hydro", "ic", "inertia",
    "inertial", "metrics", "moments", "orbital", "position", "propulsion", "simulation", "tank", "velocities",
)  # fmt: skip
"""First parts of the names of JSBSim's own properties."""
_SECTIONS = frozenset({"system", "autopilot", "flight_control", "aerodynamics", "channel", "metrics"})
"""Elements whose own ``property`` is a declaration."""
_PROSE = frozenset({"description", "documentation", "note", "reference", "fileheader", "tableData"})
"""Elements whose text is no property."""
_NAME = re.compile(r"(?<![\w/.-])-?(/?[A-Za-z_][\w.\[\]-]*(?:/[A-Za-z_][\w.\[\]-]*)+)")


def foreign_properties(roots: Iterable[ET.Element]) -> tuple[str, ...]:
    """Return the names of properties that a model reads, that it writes nowhere, and that JSBSim has not.

    Parameters
    ----------
    roots
        Outermost elements of the model's files.
    """
    read: dict[str, None] = {}
    written: set[str] = set()
    for root in roots:
        for parent, element in _without_prose(root, root):
            text = element.text or ""
            named = element.get("name", "")
            if named:
                written.update((named, f"fcs/{_dashed(named)}"))
            if element.tag == "output" or (element.tag == "property" and parent.tag in _SECTIONS):
                written.add(text.strip())
                continue
            values = [text, *(v for k, v in element.attrib.items() if k == "value")]
            read.update((name, None) for value in values for name in _NAME.findall(value))
    return tuple(name for name in read if name not in written and name.lstrip("/").split("/")[0] not in _OWN)


def _without_prose(parent: ET.Element, element: ET.Element) -> Iterator[tuple[ET.Element, ET.Element]]:
    """Yield every element that holds no prose, after its parent."""
    if element.tag in _PROSE:
        return
    yield parent, element
    for child in element:
        yield from _without_prose(element, child)


def _dashed(name: str) -> str:
    """Return the name of a component as JSBSim spells its property."""
    return name.strip().lower().replace(" ", "-")
