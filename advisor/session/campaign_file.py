"""The file of a flight test's options next to its recording: ``flight.campaign.yaml``.

``advisor live --resume`` reads this file, so that nobody must remember the options of the first start.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from advisor.aircraft.aircraft import Aircraft, Rule
from advisor.aircraft_file.read import parse_aircraft
from advisor.process.atomic_file import write_atomically
from advisor.process.settings_file import read_settings, strict

SUFFIX = ".campaign.yaml"
_KEYS = ("master", "rule", "target_system", "aircraft")
_HEADING = "# Options of this flight test; `advisor live --resume` reads this file with its recording.\n"


@strict
@dataclass(frozen=True, slots=True)
class CampaignFile:
    """Options of a flight test that a resumed flight test uses again."""

    master: str
    """Address of the connection, as in pymavlink."""
    rule: Rule | None = None
    """Stopping rule from the command line. None: the aircraft file's rule."""
    target_system: int | None = None
    aircraft: Any = None
    """Content of the aircraft file. None: no file."""

    def parsed_aircraft(self, origin: str) -> Aircraft:
        """Return the aircraft of the flight test, with the stopping rule of the command line if one was
        given.

        Raises
        ------
        ConfigurationError
            The content is no aircraft file.
        """
        aircraft = parse_aircraft(self.aircraft or {}, origin)
        if self.rule is None:
            return aircraft
        return replace(aircraft, campaign=replace(aircraft.campaign, rule=self.rule))


def path_beside(recording: Path) -> Path:
    """Return the path of the campaign file next to a recording."""
    return recording.with_suffix(SUFFIX)


def write_campaign(recording: Path, campaign: CampaignFile) -> None:
    """Write the options next to a recording.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    content = {key: value for key in _KEYS if (value := getattr(campaign, key)) is not None}
    write_atomically(
        path_beside(recording), _HEADING + yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
    )


def read_campaign(recording: Path) -> CampaignFile | None:
    """Read the options of a flight test; None without a file.

    Raises
    ------
    ConfigurationError
        The file cannot be read, or is not what ``write_campaign`` writes.
    """
    path = path_beside(recording)
    if not path.exists():
        return None
    return read_settings(path, CampaignFile, "Fix the file, or move it away and give the options again.")
