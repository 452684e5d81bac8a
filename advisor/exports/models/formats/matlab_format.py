"""``matlab``: a script for MATLAB and Octave with the matrices of both axes."""

from pathlib import Path

from advisor.exports.models.exported import Exported
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.formats import ModelFormat
from advisor.exports.models.matlab_side import both_axes_text


class MatlabFormat(ModelFormat):
    """A script that needs nothing."""

    suffix = ".m"

    def made(self, model: FlownModel, file: Path) -> Exported:
        """Return the script."""
        return both_axes_text(model)


FORMAT = MatlabFormat()
