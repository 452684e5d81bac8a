"""Lines of a campaign without a screen on a narrow terminal."""

import sys

import pytest

from advisor.cli import screen

LINE = "    next: reverse 1-2-2-1-1, 0.3 s steps, 6 % stick; about 13 more, 9 times in 10 at most 16"


def printed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], terminal: bool) -> list[str]:
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: terminal)
    screen.say(LINE)
    return capsys.readouterr().out.splitlines()


def test_a_long_line_is_wrapped_between_words_on_a_terminal(monkeypatch, capsys) -> None:
    lines = printed(monkeypatch, capsys, terminal=True)
    assert lines == [
        "    next: reverse 1-2-2-1-1, 0.3 s steps, 6 % stick; about",
        "        13 more, 9 times in 10 at most 16",
    ]


def test_a_file_gets_each_line_whole(monkeypatch, capsys) -> None:
    assert printed(monkeypatch, capsys, terminal=False) == [LINE]
