"""``ardupilot``: coefficients of the built-in plane and, next to them, parameters of its servos."""

from dataclasses import replace
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.ardupilot.plane import FRAME_WORDS, lacking, plane_text
from advisor.exports.models.ardupilot.servos import parameters_text
from advisor.exports.models.exported import Exported
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.formats import AxisAsked, ModelFormat, refuse_lacking
from advisor.words.problems import ConfigurationError

PARAMETERS = ".parm"
"""Ending of the file of parameters that stands next to the coefficients."""
ENDINGS = (PARAMETERS, ".param")
"""Endings of ArduPilot's parameter files."""


class ArduPilotFormat(ModelFormat):
    """``.json`` with ``.parm`` next to it, or ``.parm`` alone."""

    suffix = ".json"

    def files(self, file: Path) -> tuple[Path, ...]:
        """Return the ordered file, and that of the servos next to coefficients."""
        return (file, file.with_suffix(PARAMETERS)) if file.suffix == self.suffix else (file,)

    def refuse(self, file: Path, aircraft: Aircraft, axis: AxisAsked) -> None:
        """Refuse an ending, a name that ArduPilot takes for a frame, and missing keys of the axis."""
        if file.suffix not in (self.suffix, *ENDINGS):
            raise ConfigurationError(
                f"--export ardupilot: {file} must end in .json (coefficients, with the servos in "
                f"{file.stem}.parm) or .parm (servos alone)."
            )
        if file.suffix != self.suffix:
            return
        word = next((w for w in FRAME_WORDS if w in file.name), None)
        if word is not None:
            raise ConfigurationError(
                f"--export ardupilot: ArduPilot takes {word} in {file.name} for one of its frames; "
                "name the file without it."
            )
        missing = lacking(aircraft)
        refuse_lacking([missing[axis]] if axis != "both" else [*missing.values()], "ardupilot")

    def made(self, model: FlownModel, file: Path) -> Exported:
        """Return the coefficients with the parameters next to them, or the parameters."""
        parameters = parameters_text(model)
        if file.suffix != self.suffix:
            return parameters
        plane = plane_text(model, file.name)
        left = tuple(dict.fromkeys((*plane.left_out, *parameters.left_out)))
        return replace(plane, left_out=left, beside=(parameters.text,))


FORMAT = ArduPilotFormat()
