"""The tools of the Model Context Protocol, called by the SDK's own client."""

import json
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import pytest

from advisor.assistant.server import Calls, RefusedError, folders_of, part_of, written

if TYPE_CHECKING:
    from mcp import Client

LOGS = Path(__file__).parents[2] / "logs"


def client_of(folder: Path, calls: Calls) -> "Client":
    """A client of the server of a folder. Its modules take a second, in every process that collects tests."""
    from mcp import Client

    from advisor.assistant.server import server_of

    return Client(server_of(folders_of([folder], 1000), calls))


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
    async with client_of(flights, Noted({})) as client:
        tools = (await client.list_tools()).tools
        assert [tool.name for tool in tools] == ["doctor", "analyze", "gap", "report"]
        assert all(tool.annotations is not None and tool.annotations.read_only_hint for tool in tools)
        assert set(tools[1].input_schema["properties"]) == {"log", "logs", "aircraft", "part"}


async def test_a_tool_answers_with_the_commands_document(flights: Path) -> None:
    calls = Noted({"schema": "advisor.analyze/1", "usable": True})
    async with client_of(flights, calls) as client:
        told = await client.call_tool("analyze", {"logs": ["a.tlog"], "aircraft": "plain.yaml"})
    assert answer(told) == calls.answer
    assert told.structured_content is None
    assert calls.called == [["analyze", str(flights / "a.tlog"), "--aircraft", str(flights / "plain.yaml")]]


@pytest.mark.parametrize("arguments", [{"log": "a.tlog"}, {"logs": ["a.tlog"]}, {"logs": "a.tlog"}])
async def test_log_and_logs_name_the_same(flights: Path, arguments: dict[str, Any]) -> None:
    calls = Noted({})
    async with client_of(flights, calls) as client:
        for tool in ("doctor", "analyze", "gap", "report"):
            await client.call_tool(tool, arguments)
    assert [called[1] for called in calls.called] == [str(flights / "a.tlog")] * 4


async def test_the_gap_gives_its_evidence_on_request(flights: Path) -> None:
    calls = Noted({"schema": "advisor.gap/1", "evidence": [1, 2, 3], "traces": []})
    async with client_of(flights, calls) as client:
        told = await client.call_tool("gap", {"log": "a.tlog"})
        asked = await client.call_tool("gap", {"log": "a.tlog", "part": "evidence"})
    left_out = "left out, 0.0 kB; ask for part evidence"
    assert answer(told) == {"schema": "advisor.gap/1", "evidence": left_out, "traces": []}
    assert answer(asked) == [1, 2, 3]


async def test_the_report_is_markdown(flights: Path) -> None:
    async with client_of(flights, Noted({})) as client:
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
async def test_what_is_not_allowed_is_refused_in_a_sentence(flights, tool, arguments, why):
    calls = Noted({})
    async with client_of(flights, calls) as client:
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


@pytest.mark.parametrize("reads_on", [pytest.param(True, marks=pytest.mark.study), False])
def test_a_client_that_leaves_during_a_call_ends_the_server_quietly(reads_on: bool) -> None:
    command = [sys.executable, "-m", "advisor", "mcp", str(LOGS)]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stderr is not None
    with process, process.stdin, process.stdout, process.stderr:
        hello = {
            "protocolVersion": "2025-06-18",
            "capabilities": {},
            "clientInfo": {"name": "x", "version": "1"},
        }
        asked = {"name": "doctor", "arguments": {"log": "arduplane-default-rates.tlog"}}
        _say(process.stdin, id=1, method="initialize", params=hello)
        process.stdout.readline()
        _say(process.stdin, method="notifications/initialized")
        _say(process.stdin, id=2, method="tools/call", params=asked)
        if not reads_on:
            process.stdout.close()
        process.stdin.close()
        assert process.wait(60.0) == 0
        assert process.stderr.read() == b""


def _say(pipe: IO[bytes], **message: Any) -> None:
    pipe.write(json.dumps({"jsonrpc": "2.0", **message}).encode() + b"\n")
    pipe.flush()


def answer(told: Any) -> Any:
    """The document in the one text of an answer."""
    (text,) = told.content
    return json.loads(text.text)


async def test_the_command_serves_a_log_to_a_client_over_its_streams(tmp_path: Path) -> None:
    """The whole way: the command in its process, the SDK's client, a real log."""
    from mcp import Client, StdioServerParameters

    shutil.copy(LOGS / "arduplane-default-rates.tlog", tmp_path / "slow.tlog")
    server = StdioServerParameters(
        command=sys.executable, args=["-m", "advisor", "mcp", str(tmp_path)], cwd=LOGS.parent
    )
    async with Client(server) as client:
        told = await client.call_tool("doctor", {"log": "slow.tlog"})
    assert answer(told)["schema"] == "advisor.doctor/1"
    assert answer(told)["limits"]


LARGE = {
    "verdict": "effect",
    "model": {"M_alpha": {"value": -4.912345678901, "ci95": [-5.0, -4.8]}},
    "maneuvers": [{"number": k, "samples": list(range(500))} for k in range(40)],
}


def test_a_short_document_is_written_whole_and_without_indent() -> None:
    assert written({"a": [1, 2.5], "b": None}) == '{"a":[1,2.5],"b":null}'


def test_a_long_document_keeps_its_verdict_and_fits() -> None:
    told = written(LARGE)
    assert len(json.dumps(told, ensure_ascii=False).encode()) <= 19_800
    document = json.loads(told)
    assert document["verdict"] == "effect"
    assert document["model"]["M_alpha"]["value"] == -4.912346


def test_every_part_that_is_left_out_can_be_asked_for() -> None:
    document = json.loads(written(LARGE))
    *kept, last = document["maneuvers"][0]["samples"]
    assert kept == list(range(len(kept)))
    assert last == f"{500 - len(kept)} more; ask for part maneuvers.0.samples.{len(kept)} and so on"
    *shown, last = document["maneuvers"]
    assert [maneuver["number"] for maneuver in shown] == list(range(len(shown)))
    assert last == f"{40 - len(shown)} more; ask for part maneuvers.{len(shown)} and so on"
    assert json.loads(written(LARGE, "maneuvers.0.samples")) == list(range(500))


def test_a_part_that_is_too_long_is_shortened_as_well() -> None:
    assert len(json.dumps(written(LARGE, "maneuvers"), ensure_ascii=False).encode()) <= 19_800


def test_the_evidence_of_either_axis_is_answered_on_request_alone() -> None:
    document = {"evidence": [], "lateral": {"verdict": "none", "evidence": [1, 2, 3]}}
    assert json.loads(written(document, without=("evidence",))) == {
        "evidence": [],
        "lateral": {"verdict": "none", "evidence": "left out, 0.0 kB; ask for part lateral.evidence"},
    }
    assert json.loads(written(document, "lateral.evidence", ("evidence",))) == [1, 2, 3]


@pytest.mark.parametrize("path", ["nothing", "maneuvers.40", "verdict.x"])
def test_a_part_that_is_not_there_is_refused_by_its_name(path: str) -> None:
    with pytest.raises(RefusedError, match=f"There is no part {path}: "):
        part_of(LARGE, path)
