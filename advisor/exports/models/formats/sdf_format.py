"""``sdf``: Gazebo's plugins of lift, drag and side force."""

from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.exported import Exported
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.formats import AxisAsked, ModelFormat, refuse_lacking
from advisor.exports.models.sdf import lacking, plugins_text


class SdfFormat(ModelFormat):
    """Plugins for a ``<model>``."""

    suffix = ".sdf"

    def refuse(self, file: Path, aircraft: Aircraft, axis: AxisAsked) -> None:
        """Refuse missing keys of the axis."""
        missing = lacking(aircraft.reference)
        refuse_lacking([missing[axis]] if axis != "both" else [*missing.values()], "sdf")

    def made(self, model: FlownModel, file: Path) -> Exported:
        """Return the plugins."""
        return plugins_text(model)


FORMAT = SdfFormat()
