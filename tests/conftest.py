"""What tests of every folder may ask for."""

from collections.abc import Callable
from subprocess import CompletedProcess

import pytest

from advisor import cli

Advisor = Callable[..., "CompletedProcess[str]"]
"""Called with the words that follow ``advisor`` on the command line."""


@pytest.fixture
def advisor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Advisor:
    """The command with all that ends it, in this process: starting another takes longer than most calls."""

    def call(*arguments: object) -> CompletedProcess[str]:
        monkeypatch.setattr("sys.argv", ["advisor", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        assert isinstance(ended.value.code, int)
        return CompletedProcess("advisor", ended.value.code, *capsys.readouterr())

    return call
