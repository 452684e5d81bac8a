"""The tools of the Model Context Protocol, called by the SDK's own client."""

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, StdioServerParameters

from advisor.assistant.calls import Calls, refuse_long
from advisor.assistant.folders import RefusedError, folders_of
from advisor.assistant.server import server_of

LOGS = Path(__file__).parents[2] / "logs"


class Noted(Calls):
    """Notes what would be called, and answers at once."""

    def __init__(self, answer: dict[str, Any]) -> None:
        super().__init__(1.0)
        self.answer = answer
        self.called: list[Sequence[str]] = []

    async def document(self, arguments: Sequence[str]) -> dict[str, Any]:
        self.called.append(arguments)
        return self.answer

    async def done(self, arguments: Sequence[str]) -> None:
        self.called.append(arguments)
        Path(arguments[-1]).write_text("# The page", encoding="utf-8")


@pytest.fixture
def flights(tmp_path: Path) -> Path:
    (tmp_path / "a.tlog").write_bytes(b"")
    (tmp_path / "plain.yaml").write_text("name: x\n", encoding="utf-8")
    (tmp_path / "runs.yaml").write_text("simulator: python:os:system\n", encoding="utf-8")
    return tmp_path


async def test_the_tools_are_doctor_analyze_gap_and_report_and_only_read(flights: Path) -> None:
    async with Client(server_of(folders_of([flights], 1000), Noted({}))) as client:
        tools = (await client.list_tools()).tools
        assert [tool.name for tool in tools] == ["doctor", "analyze", "gap", "report"]
        assert all(tool.annotations is not None and tool.annotations.read_only_hint for tool in tools)
        assert set(tools[1].input_schema["properties"]) == {"logs", "aircraft"}


async def test_a_tool_answers_with_the_commands_document(flights: Path) -> None:
    calls = Noted({"schema": "advisor.analyze/1", "usable": True})
    async with Client(server_of(folders_of([flights], 1000), calls)) as client:
        told = await client.call_tool("analyze", {"logs": ["a.tlog"], "aircraft": "plain.yaml"})
    assert told.structured_content == calls.answer
    assert calls.called == [["analyze", str(flights / "a.tlog"), "--aircraft", str(flights / "plain.yaml")]]


async def test_the_gap_comes_without_its_traces(flights: Path) -> None:
    calls = Noted({"schema": "advisor.gap/1", "traces": [1, 2, 3]})
    async with Client(server_of(folders_of([flights], 1000), calls)) as client:
        told = await client.call_tool("gap", {"logs": ["a.tlog"]})
    assert told.structured_content == {"schema": "advisor.gap/1", "traces": []}


async def test_the_report_is_markdown(flights: Path) -> None:
    async with Client(server_of(folders_of([flights], 1000), Noted({}))) as client:
        told = await client.call_tool("report", {"logs": ["a.tlog"]})
    assert told.content[0].text == "# The page"


@pytest.mark.parametrize(
    ("tool", "arguments", "why"),
    [
        ("doctor", {"log": "../x.tlog"}, "outside the folders"),
        ("analyze", {"logs": []}, "at least one log"),
        ("gap", {"logs": ["a.tlog"], "aircraft": "runs.yaml"}, "runs a program"),
    ],
)
async def test_what_is_not_allowed_is_refused_in_a_sentence(
    flights: Path, tool: str, arguments: dict[str, Any], why: str
) -> None:
    calls = Noted({})
    async with Client(server_of(folders_of([flights], 1000), calls)) as client:
        told = await client.call_tool(tool, arguments)
    assert told.is_error
    assert why in told.content[0].text
    assert calls.called == []


async def test_a_command_that_takes_too_long_is_ended() -> None:
    with pytest.raises(RefusedError, match="was ended after 0 s"):
        await Calls(0.05).document(["locate", "config"])


async def test_a_command_that_prints_no_document_is_refused_with_its_sentence() -> None:
    with pytest.raises(RefusedError, match="none of theirs"):
        await Calls(60.0).document(["none of theirs"])


def test_an_answer_above_a_megabyte_is_refused() -> None:
    with pytest.raises(RefusedError, match="longer than 1 MB"):
        refuse_long("x" * 1_000_001)


async def test_the_command_serves_a_log_to_a_client_over_its_streams(tmp_path: Path) -> None:
    """The whole way: the command in its process, the SDK's client, a real log."""
    shutil.copy(LOGS / "arduplane-default-rates.tlog", tmp_path / "slow.tlog")
    server = StdioServerParameters(
        command=sys.executable, args=["-m", "advisor", "mcp", str(tmp_path)], cwd=LOGS.parent
    )
    async with Client(server) as client:
        told = await client.call_tool("doctor", {"log": "slow.tlog"})
    assert told.structured_content["schema"] == "advisor.doctor/1"
    assert told.structured_content["limits"]
