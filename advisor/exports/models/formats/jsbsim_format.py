"""``jsbsim``: a copy of the user's own JSBSim aircraft, corrected in both axes."""

from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.exported import Exported
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.formats import AxisAsked, ModelFormat
from advisor.exports.models.jsbsim.aircraft import aircraft_text
from advisor.exports.models.jsbsim.run import Model, model_of
from advisor.exports.models.jsbsim.side import side_text
from advisor.words.problems import ConfigurationError


class JsbsimFormat(ModelFormat):
    """The aircraft that ``simulator: jsbsim:MODEL`` names."""

    suffix = ".xml"
    needs_a_finding = True

    def refuse(self, file: Path, aircraft: Aircraft, axis: AxisAsked) -> None:
        """Refuse an aircraft file without a JSBSim aircraft, and to replace that aircraft."""
        if file.resolve() == _model(aircraft).file:
            raise ConfigurationError(
                f"--export jsbsim: {file} is the simulator's own aircraft; name another file."
            )

    def made(self, model: FlownModel, file: Path) -> Exported:
        """Return the aircraft with pitch corrected, then roll and yaw."""
        own = _model(model.aircraft)
        content, left = own.file.read_bytes(), []
        if model.pitch is not None:
            made = aircraft_text(model.pitch, own)
            content, left = made.text.encode(), [*made.left_out]
        if model.side is not None and model.side.flown:
            made = side_text(model.name, model.side, own, content)
            content, left = made.text.encode(), [*left, *made.left_out]
        return Exported(content.decode(), tuple(left))


def _model(aircraft: Aircraft) -> Model:
    """Return the user's JSBSim aircraft, from the specification of the simulator."""
    kind, _, what = (aircraft.simulator or "").partition(":")
    if kind != "jsbsim" or not what:
        raise ConfigurationError(
            "--export jsbsim corrects a JSBSim aircraft: give yours with simulator: jsbsim:MODEL in the "
            "aircraft file."
        )
    return model_of(what)


FORMAT = JsbsimFormat()
