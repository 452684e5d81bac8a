"""Settings of the screens, from the settings file of the user."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, get_args

from advisor.words.problems import ConfigurationError

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
    from advisor.process.yaml_file import read_yaml

    path = path or settings_path()
    if not path.exists():
        return Settings()
    data = read_yaml(path, "See `advisor locate config`.") or {}
    if not isinstance(data, dict):
        raise ConfigurationError(
            f"{path} must hold keys and values, as in `theme: light`. Fix the file, or move it away."
        )
    mistakes = [*_unknown(data), *_wrong(data)]
    if mistakes:
        raise ConfigurationError(f"{path}: {'; '.join(mistakes)}. Fix the file, or move it away.")
    return Settings(**data)


def _unknown(data: dict[str, Any]) -> list[str]:
    keys = [f.name for f in fields(Settings)]
    return [f"unknown key {key!r} (known: {', '.join(keys)})" for key in data if key not in keys]


def _wrong(data: dict[str, Any]) -> list[str]:
    from advisor.tui.keys import ACTIONS
    from advisor.tui.themes import NAMES

    mistakes = []
    for key, allowed in (("theme", NAMES), ("screen", get_args(Face))):
        if key in data and data[key] not in allowed:
            mistakes.append(f"{key}: {data[key]!r} is none of {', '.join(allowed)}")
    if not isinstance(data.get("sound", True), bool):
        mistakes.append(f"sound: {data['sound']!r} is neither true nor false")
    keys = data.get("keys", {})
    if not isinstance(keys, dict):
        return [*mistakes, "keys: must map actions to keys, as in `keys: {quit: ctrl+q}`"]
    for action, key in keys.items():
        if action not in ACTIONS:
            mistakes.append(f"keys.{action}: no such action (known: {', '.join(sorted(ACTIONS))})")
        elif not isinstance(key, str) or not key:
            mistakes.append(f"keys.{action}: {key!r} is no key, as `ctrl+q` would be")
    return mistakes
