"""Where settings and recordings are kept can be asked."""

import pytest
from click.testing import CliRunner

from advisor.cli.locate import command
from advisor.tui.settings import settings_path


def test_the_settings_file_is_where_the_command_says():
    assert CliRunner().invoke(command, ["config"]).output.strip() == str(settings_path())


@pytest.mark.parametrize("what", ["config", "recordings"])
def test_a_place_is_one_line(what: str):
    result = CliRunner().invoke(command, [what])
    assert result.exit_code == 0
    assert len(result.output.strip().splitlines()) == 1
