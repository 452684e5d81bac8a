"""Shells complete commands, options and files."""

import pytest

from tests.conftest import Advisor
from tests.rows import row


@pytest.fixture
def completed(advisor: Advisor, monkeypatch: pytest.MonkeyPatch):
    """What bash is offered for a line whose last word is being typed."""

    def offer(line: str) -> list[str]:
        words = line.split(" ")
        monkeypatch.setenv("COMP_WORDS", line)
        monkeypatch.setenv("COMP_CWORD", str(len(words) - 1))
        monkeypatch.setenv("_ADVISOR_COMPLETE", "bash_complete")
        run = advisor()
        assert run.returncode == 0
        return run.stdout.split()

    return offer


@row("a command is completed", "advisor an", ["plain,analyze"])
@row("an option is completed", "advisor analyze a.tlog --ru", ["plain,--rule"])
@row("a command within a command is completed", "advisor aircraft ch", ["plain,check"])
def test_a_word_is_completed(line: str, offered: list[str], completed) -> None:
    assert completed(line) == offered


def test_the_values_of_an_option_are_completed(completed) -> None:
    assert "plain,information" in completed("advisor analyze a.tlog --rule ")


@pytest.mark.parametrize("line", ["advisor analyze fl", "advisor doctor fl", "advisor gap --aircraft fl"])
def test_a_file_is_left_to_the_shell(completed, line: str) -> None:
    assert completed(line) == ["file,fl"] or completed(line) == ["file,"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_every_shell_has_its_script(advisor: Advisor, shell: str) -> None:
    assert "_ADVISOR_COMPLETE" in advisor("completion", shell).stdout
