"""The walls of the house stand around every room of it."""

import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
NO_ROOM = {"__init__", "__main__"}


def contracts() -> list[dict[str, Any]]:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return list(settings["tool"]["importlinter"]["contracts"])


def test_every_room_of_the_advisor_has_a_floor():
    layers = next(c for c in contracts() if c["name"].startswith("Data flows one way"))["layers"]
    floors = {name.strip().removeprefix("advisor.") for layer in layers for name in layer.split(":")}
    rooms = {
        p.stem for p in (ROOT / "advisor").iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()
    }
    assert floors == rooms - NO_ROOM


def test_only_the_bundled_room_may_import_the_simulator():
    wall = next(c for c in contracts() if c.get("forbidden_modules") == ["sim"])
    assert wall["source_modules"] == ["advisor.*"]
    assert wall["ignore_imports"] == ["advisor.bundled.** -> sim.**"]
