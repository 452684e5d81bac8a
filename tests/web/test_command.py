"""What ``advisor serve`` refuses before anything is opened: one sentence and the contract's exit code."""

import importlib.util
import io
import socket
from pathlib import Path

import pytest

from tests.conftest import Advisor

LOG = Path(__file__).parents[2] / "logs" / "bundled-demo.tlog"
LIVE = ("serve", "live", "--master", "udpin:127.0.0.1:0")


def test_a_port_in_use_is_refused(advisor: Advisor) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        result = advisor(*LIVE, "--port", port)
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert f"port {port}: Address already in use. End the program" in result.stderr


def test_another_host_needs_a_password(advisor: Advisor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO())
    result = advisor(*LIVE, "--host", "0.0.0.0")
    assert result.returncode == 2
    assert "--host 0.0.0.0 opens the pages to other computers and needs a password" in result.stderr


def test_a_password_that_can_be_guessed_is_refused(advisor, tmp_path, monkeypatch):
    file = tmp_path / "crew.txt"
    file.write_text("1234567\n")
    file.chmod(0o600)
    result = advisor(*LIVE, "--password-file", file)
    assert (result.returncode, "holds 7 characters" in result.stderr) == (2, True)
    monkeypatch.setenv("ADVISOR_PASSWORD", "short")
    assert "ADVISOR_PASSWORD holds 5 characters" in advisor(*LIVE).stderr


def test_a_log_that_is_none_is_refused_before_a_page_is_opened(advisor: Advisor, tmp_path: Path) -> None:
    assert advisor("serve", "replay", tmp_path / "missing.tlog").returncode == 3


def test_a_missing_extra_is_named(advisor: Advisor, monkeypatch: pytest.MonkeyPatch) -> None:
    find_spec = importlib.util.find_spec
    monkeypatch.setattr(
        "advisor.web.serving.find_spec", lambda name: None if name == "textual_serve" else find_spec(name)
    )
    result = advisor("serve", "replay", LOG)
    assert result.returncode == 2
    assert "pip install 'inflight-advisor[web]'" in result.stderr
