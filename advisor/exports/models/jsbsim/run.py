"""Location of a JSBSim aircraft, and its measurement in a separate process."""

import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from advisor.exports.models.jsbsim.slopes import Request, SideSlopes, Slopes
from advisor.exports.models.jsbsim.source import parse
from advisor.process.children import python_module
from advisor.simulators.jsbsim_model import find_model, foreign_properties
from advisor.words.problems import ConfigurationError

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
