"""The server of the Model Context Protocol: four read-only tools over the advisor's own commands."""

import json
from collections.abc import Awaitable, Callable, Sequence
from functools import wraps
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations

from advisor import __version__
from advisor.aircraft_file.read import load_aircraft
from advisor.assistant.calls import Calls, refuse_long
from advisor.assistant.folders import Folders, RefusedError
from advisor.words.problems import ConfigurationError

_READS = ToolAnnotations(read_only_hint=True, destructive_hint=False, idempotent_hint=True)
_SAFE_SIMULATORS = (None, "linear")
"""Simulators of an aircraft file that run no program of the file's choice."""
_INSTRUCTIONS = """\
Flight-test analysis of fixed-wing aircraft from MAVLink logs (.tlog, .bin, .ulg). Ask doctor first whether
a log can serve, analyze for verdicts and derivatives, gap for why the aircraft does not fly like its
simulator, report for a page. Documents are in SI units. Quote values with their ci95, and quote the
sentences of verdicts as they stand. Paths may be relative to: {folders}. Logs: {logs}.
"""
_LISTED = 50
"""Most logs that the instructions name."""

Tool = Callable[..., Awaitable[Any]]


def server_of(folders: Folders, calls: Calls) -> MCPServer[Any]:
    """Return the server with its tools.

    Parameters
    ----------
    folders
        Files that the tools may read.
    calls
        Runs the commands of the advisor.
    """
    logs = [str(path) for path in folders.logs()]
    named = ", ".join(logs[:_LISTED]) + (f" and {len(logs) - _LISTED} more" if len(logs) > _LISTED else "")
    told = _INSTRUCTIONS.format(folders=folders.listed, logs=named or "none yet")
    server: MCPServer[Any] = MCPServer("inflight-advisor", instructions=told, version=__version__)

    async def doctor(log: str, aircraft: str | None = None) -> dict[str, Any]:
        """Say whether the telemetry of a log is good enough, and what to change (advisor.doctor/1)."""
        return await calls.document(["doctor", str(folders.file(log)), *_aircraft(folders, aircraft)])

    async def analyze(logs: list[str], aircraft: str | None = None) -> dict[str, Any]:
        """Judge every manoeuvre, estimate the derivatives, and say stop or continue (advisor.analyze/1)."""
        return await calls.document(["analyze", *_files(folders, logs), *_aircraft(folders, aircraft)])

    async def gap(logs: list[str], aircraft: str | None = None) -> dict[str, Any]:
        """Say why the aircraft does not fly like its simulator (advisor.gap/1, without traces)."""
        words = ["gap", *_files(folders, logs), *_aircraft(folders, aircraft, flies=True)]
        return {**await calls.document(words), "traces": []}

    async def report(logs: list[str], aircraft: str | None = None) -> str:
        """Write the page of a flight, as Markdown."""
        with TemporaryDirectory() as folder:
            page = Path(folder) / "report.md"
            words = ["report", *_files(folders, logs), *_aircraft(folders, aircraft), "-o", str(page)]
            await calls.done(words)
            return page.read_text(encoding="utf-8")

    for tool, structured in ((doctor, True), (analyze, True), (gap, True), (report, False)):
        server.add_tool(
            _answering(tool), name=tool.__name__, annotations=_READS, structured_output=structured
        )
    return server


def _answering(tool: Tool) -> Tool:
    """Return the tool with an answer of a limited length, and a refusal as a sentence."""

    @wraps(tool)
    async def answer(**arguments: Any) -> Any:
        try:
            told = await tool(**arguments)
            refuse_long(told if isinstance(told, str) else json.dumps(told))
        except RefusedError as refused:
            raise ToolError(str(refused)) from refused
        return told

    return answer


def _files(folders: Folders, names: Sequence[str]) -> list[str]:
    """Return the paths of the logs; none of them can be taken for an option."""
    if not names:
        raise RefusedError("Name at least one log.")
    return [str(folders.file(name)) for name in names]


def _aircraft(folders: Folders, name: str | None, flies: bool = False) -> list[str]:
    """Return the option of an aircraft file.

    With ``flies`` the command flies the file's simulator, so a simulator that runs a program is refused.
    """
    if name is None:
        return []
    path = folders.file(name)
    if flies:
        try:
            simulator = load_aircraft(path).simulator
        except ConfigurationError as error:
            raise RefusedError(str(error)) from error
        if simulator not in _SAFE_SIMULATORS:
            raise RefusedError(
                f"{name} names the simulator {simulator}, which runs a program or reads another file. "
                "This server flies the aircraft file's model only: run advisor gap in a terminal."
            )
    return ["--aircraft", str(path)]
