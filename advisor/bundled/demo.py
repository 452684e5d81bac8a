"""The demonstration: the bundled aircraft flies as a process of its own, over a real MAVLink link.

Only this module and the study use the simulator directly. The advisor receives the simulator's messages by
MAVLink, like those of any aircraft.
"""

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from advisor.process.children import python_module
from advisor.process.installed import SIMULATOR
from advisor.words.problems import UnusableInputError

if TYPE_CHECKING:
    from advisor.mavlink.link.link import Link

LANDING_S = 2.0
"""Silence of the link after the end of the aircraft's process, s, that ends the flight."""


class Demonstration:
    """A flight of the bundled aircraft, and the link to it.

    Parameters
    ----------
    aircraft
        One of the simulator's aircraft: ``linear`` is the paper's model.
    speed
        Multiple of real time, as ``python -m sim fly --speed`` takes it.
    """

    def __init__(self, aircraft: str, speed: float, seed: int, record_to: Path | None = None) -> None:
        self._options = ["--aircraft", aircraft, "--speed", f"{speed:g}", "--seed", str(seed)]
        self._record_to = record_to
        self._link: Link | None = None
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> "Link":
        # The decoders of a link take longer to load than the first screen takes to paint.
        from advisor.mavlink.link.link import Link

        self._link = Link("udpin:127.0.0.1:0", record_to=self._record_to).start()
        command = [*python_module(SIMULATOR), "fly", "--master", f"udpout:127.0.0.1:{self._link.port}"]
        self._process = subprocess.Popen(
            [*command, *self._options],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        return self._link

    def __exit__(self, *error: object) -> None:
        if self._link is not None:
            self._link.stop()
        if self._process is not None:
            self._process.terminate()
            self._process.communicate()

    @staticmethod
    def fly_once() -> None:
        """Fly one manoeuvre into a temporary file, in order to compile all functions of the aircraft."""
        with TemporaryDirectory() as folder:
            scenario = Path(folder) / "one.yaml"
            scenario.write_text('aircraft: linear\nmaneuvers: ["3211"]\n')
            out = Path(folder) / "one.tlog"
            command = [*python_module(SIMULATOR), "record", "--scenario", str(scenario)]
            subprocess.run(
                [*command, "--out", str(out)], stdin=subprocess.DEVNULL, capture_output=True, check=False
            )

    def over(self) -> bool:
        """Return whether the aircraft has landed and the advisor has received its last packets.

        Raises
        ------
        UnusableInputError
            The aircraft could not fly.
        """
        if self._link is None or self._process is None:
            return False
        code = self._process.poll()
        if code:
            said = self._process.stderr.read().decode(errors="replace") if self._process.stderr else ""
            raise UnusableInputError(
                "no_flight",
                f"The bundled aircraft ended with exit code {code}: {said.strip()}",
                f"Try: python -m {SIMULATOR} fly --master udpout:127.0.0.1:14550",
            )
        return code == 0 and self._link.statistics.silent_s > LANDING_S
