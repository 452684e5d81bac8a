"""The walls of the house stand around every part of it."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_every_part_of_the_advisor_but_the_demo_and_the_study_is_kept_from_the_simulator():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contract = next(
        c for c in settings["tool"]["importlinter"]["contracts"] if c["name"].startswith("The advisor meets")
    )
    parts = {
        p.stem for p in (ROOT / "advisor").iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()
    }
    kept = {name.removeprefix("advisor.") for name in contract["source_modules"]}
    assert kept == parts - {"__init__", "demo", "study"}
