"""Settings of the screens, from the settings file of the user."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

Face = Literal["pilot", "engineer"]


@dataclass(frozen=True, slots=True)
class Settings:
    """Content of the settings file, whose path ``advisor locate config`` prints. Every key is optional.

    An example::

        theme: light
        screen: engineer
        keys: {quit: ctrl+q, pause: "space,k"}
    """

    theme: str = "dark"
    """``dark``, ``light`` (cockpit sun), ``high contrast`` or ``colour-blind safe``."""
    screen: Face = "pilot"
    """Screen at the start."""
    sound: bool = True
    """Whether a bell rings and the system's voice speaks at each verdict."""
    keys: Mapping[str, str] = field(default_factory=dict)
    """Keys of each action, by the action's name; several keys are separated by commas. ``?`` on a screen
    lists the actions."""


def settings_path() -> Path:
    """Return the path of the settings file on this system, whether the file exists or not."""
    from platformdirs import user_config_path

    return user_config_path("inflight-advisor") / "settings.yaml"


def load_settings(path: Path | None = None) -> Settings:
    """Read the settings file. Without a file, return the defaults.

    Raises
    ------
    ConfigurationError
        The file has mistakes. The message lists each with its key and the allowed values.
    """
    from advisor.process.settings_file import read_settings, strict

    path = path or settings_path()
    if not path.exists():
        return Settings()
    return read_settings(path, strict(Settings), "Fix the file, or move it away.", _wrong)


def _wrong(settings: Settings) -> Iterator[str]:
    from advisor.tui.keys import ACTIONS
    from advisor.tui.themes import NAMES

    if settings.theme not in NAMES:
        yield f"theme: {settings.theme!r} is none of {', '.join(NAMES)}"
    for action in settings.keys:
        if action not in ACTIONS:
            yield f"keys.{action}: no such action (known: {', '.join(sorted(ACTIONS))})"
