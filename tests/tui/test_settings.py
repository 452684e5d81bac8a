"""The settings file: what it may say, and what is answered to what it may not."""

from pathlib import Path

import pytest

from advisor.tui.settings import Settings, load_settings
from advisor.words.problems import ConfigurationError


def written(folder: Path, text: str) -> Path:
    path = folder / "settings.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_without_a_file_the_defaults_hold(tmp_path: Path):
    assert load_settings(tmp_path / "none.yaml") == Settings()


def test_an_empty_file_changes_nothing(tmp_path: Path):
    assert load_settings(written(tmp_path, "")) == Settings()


def test_what_the_file_says_holds(tmp_path: Path):
    settings = load_settings(
        written(tmp_path, "theme: light\nscreen: engineer\nsound: false\nkeys: {quit: ctrl+q}\n")
    )
    assert settings == Settings("light", "engineer", sound=False, keys={"quit": "ctrl+q"})


def test_every_mistake_is_listed_at_once(tmp_path: Path):
    text = "theme: pink\nscren: pilot\nsound: loud\nkeys: {quit: 7, fly: f}\n"
    with pytest.raises(ConfigurationError) as caught:
        load_settings(written(tmp_path, text))
    for part in (
        "theme: 'pink'",
        "scren: unknown key (did you mean screen?)",
        "sound: input should be a valid boolean",
        "keys.quit: input should be a valid string",
        "keys.fly: no such action",
    ):
        assert part in str(caught.value)


@pytest.mark.parametrize("text", ["- a\n- b\n", "theme: [", "keys: quit\n"])
def test_what_is_no_mapping_is_refused_in_a_sentence(tmp_path: Path, text: str):
    with pytest.raises(ConfigurationError, match=r"settings\.yaml"):
        load_settings(written(tmp_path, text))
