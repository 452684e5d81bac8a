"""A layout for PlotJuggler next to a record's grid, which groups curves into plots."""

from pathlib import Path
from xml.etree import ElementTree as Xml

from advisor.exports.flights.table import Dataset, Recording

LAYOUT = "plotjuggler.xml"
_PLOTS = (("elevator",), ("alpha", "theta"), ("q",), ("a_z",), ("airspeed",), ("height",))
_COMMA = {"time_axis": "t_boot_s", "delimiter": "0"}
_LOADERS = {
    "csv": ("DataLoad CSV", {"default": _COMMA, "parameters": _COMMA}),
    "parquet": ("DataLoad Parquet", {"default": {"prevTimestamp": "t_boot_s", "radioIndexChecked": "0"}}),
}
"""PlotJuggler's reader of each file ending, and the places where its releases seek the times."""
_COLORS = ("#1f77b4", "#d62728")


def write_layouts(data: Dataset, folder: Path, ending: str) -> None:
    """Write ``record_N/plotjuggler.xml``, which loads ``record_N/grid.ENDING`` over ``t_boot_s``."""
    for recording in data.recordings:
        text = Xml.tostring(layout(recording, ending), encoding="unicode")
        (folder / recording.name).mkdir(exist_ok=True)
        (folder / recording.name / LAYOUT).write_text(f'<?xml version="1.0"?>\n{text}\n', encoding="utf-8")


def layout(recording: Recording, ending: str) -> Xml.Element:
    """Return one tab of plots, one above the other, of the record's channels."""
    there = {column.name for column in recording.grid.columns}
    plots = [names for plot in _PLOTS if (names := [name for name in plot if name in there])]
    root = Xml.Element("root")
    tabs = Xml.SubElement(root, "tabbed_widget", {"parent": "main_window", "name": "Main Window"})
    tab = Xml.SubElement(tabs, "Tab", containers="1", tab_name=recording.name)
    container = Xml.SubElement(tab, "Container")
    share = ";".join(f"{1.0 / len(plots):.6f}" for _ in plots)
    splitter = Xml.SubElement(container, "DockSplitter", orientation="-", sizes=share, count=str(len(plots)))
    for names in plots:
        area = Xml.SubElement(splitter, "DockArea", name=", ".join(names))
        plot = Xml.SubElement(area, "plot", style="Lines", mode="TimeSeries")
        for name, color in zip(names, _COLORS, strict=False):
            Xml.SubElement(plot, "curve", name=name, color=color)
    Xml.SubElement(tabs, "currentTabIndex", index="0")
    files = Xml.SubElement(root, "previouslyLoaded_Datafiles")
    file = Xml.SubElement(files, "fileInfo", filename=f"grid.{ending}", prefix="")
    name, elements = _LOADERS[ending]
    plugin = Xml.SubElement(file, "plugin", ID=name)
    for element, settings in elements.items():
        Xml.SubElement(plugin, element, settings)
    Xml.SubElement(root, "use_relative_time_offset", enabled="0")
    return root
