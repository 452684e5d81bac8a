"""Format ``aircraft``: the aircraft file with the results of the flight."""

from pathlib import Path

from advisor.exports.models.flown import FlownModel, file_text
from advisor.exports.models.formats import ModelFormat
from advisor.exports.models.improvement import Exported


class AircraftFormat(ModelFormat):
    """Aircraft file that ``advisor`` and ``python -m sim`` load."""

    suffix = ".yaml"
    needs_a_finding = True

    def made(self, model: FlownModel, file: Path) -> Exported:
        return Exported(file_text(model), model.beyond_keys)


FORMAT = AircraftFormat()
