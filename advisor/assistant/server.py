"""The server of the Model Context Protocol: four read-only tools over the advisor's own commands."""

from collections.abc import Awaitable, Callable
from functools import wraps
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations

from advisor import __version__
from advisor.aircraft_file.read import load_aircraft
from advisor.assistant.calls import Calls
from advisor.assistant.fitting import fits, written
from advisor.assistant.folders import Folders, RefusedError
from advisor.words.problems import ConfigurationError

_READS = ToolAnnotations(read_only_hint=True, destructive_hint=False, idempotent_hint=True)
_SAFE_SIMULATORS = (None, "linear")
"""Kinds of simulators that run no program named by the aircraft file."""
_INSTRUCTIONS = """\
Flight-test analysis of fixed-wing aircraft from MAVLink logs (.tlog, .bin, .ulg). Ask doctor first whether
a log can serve, analyze for verdicts and derivatives, gap for why the aircraft does not fly like its
simulator, report for a page. Documents are in SI units. Quote values with their ci95, and quote the
sentences of verdicts as they stand. An answer has at most 20 kB; what it leaves out names the "part" to ask
for. Paths may be relative to: {folders}. Logs: {logs}.
"""
_LISTED = 50
"""Largest number of logs in the instructions."""

_EVIDENCE = ("traces", "evidence", "decisions")
"""Parts of a gap's document that are sent only on request."""

Names = list[str] | str | None
"""Names of logs in a request: several, one, or none."""
Tool = Callable[..., Awaitable[Any]]


def server_of(folders: Folders, calls: Calls) -> MCPServer[Any]:
    """Return the server with its tools."""
    logs = [str(path) for path in folders.logs()]
    named = ", ".join(logs[:_LISTED]) + (f" and {len(logs) - _LISTED} more" if len(logs) > _LISTED else "")
    instructions = _INSTRUCTIONS.format(folders=folders.listed, logs=named or "none yet")
    # The library logs the answer that a client no longer reads; refusals and faults are answers.
    server: MCPServer[Any] = MCPServer(
        "inflight-advisor", instructions=instructions, version=__version__, log_level="CRITICAL"
    )

    async def doctor(
        log: str | None = None, logs: Names = None, aircraft: str | None = None, part: str = ""
    ) -> str:
        """Say whether the telemetry of a log is good enough, and what to change (advisor.doctor/1)."""
        files = _files(folders, log, logs)
        if len(files) > 1:
            raise RefusedError("doctor reads one log at a time: name one.")
        return written(await calls.document(["doctor", *files, *_aircraft(folders, aircraft)]), part)

    async def analyze(
        log: str | None = None, logs: Names = None, aircraft: str | None = None, part: str = ""
    ) -> str:
        """Judge every manoeuvre, estimate the derivatives, and say stop or continue (advisor.analyze/1)."""
        words = ["analyze", *_files(folders, log, logs), *_aircraft(folders, aircraft)]
        return written(await calls.document(words), part)

    async def gap(
        log: str | None = None, logs: Names = None, aircraft: str | None = None, part: str = ""
    ) -> str:
        """Say why the aircraft does not fly like its simulator (advisor.gap/1)."""
        words = ["gap", *_files(folders, log, logs), *_aircraft(folders, aircraft, flies=True)]
        return written(await calls.document(words), part, _EVIDENCE)

    async def report(log: str | None = None, logs: Names = None, aircraft: str | None = None) -> str:
        """Write the page of a flight, as Markdown."""
        with TemporaryDirectory() as folder:
            page = Path(folder) / "report.md"
            words = ["report", *_files(folders, log, logs), *_aircraft(folders, aircraft), "-o", str(page)]
            await calls.done(words)
            text = page.read_text(encoding="utf-8")
        answer, lines = text, text.splitlines()
        while not fits(answer):
            lines = lines[:-1]
            answer = "\n".join([*lines, "", "Cut here: analyze has the rest."])
        return answer

    for tool in (doctor, analyze, gap, report):
        server.add_tool(_answering(tool), name=tool.__name__, annotations=_READS, structured_output=False)
    return server


def _answering(tool: Tool) -> Tool:
    """Return the tool, whose refusals become sentences."""

    @wraps(tool)
    async def answer(**arguments: Any) -> Any:
        try:
            return await tool(**arguments)
        except RefusedError as refused:
            raise ToolError(str(refused)) from refused

    return answer


def _files(folders: Folders, log: str | None, logs: Names) -> list[str]:
    """Return the paths of the logs of both arguments, written so that no path is taken for an option."""
    names = [log] if log is not None else []
    names += [logs] if isinstance(logs, str) else logs or []
    if not names:
        raise RefusedError("Name at least one log.")
    return [str(folders.file(name)) for name in names]


def _aircraft(folders: Folders, name: str | None, flies: bool = False) -> list[str]:
    """Return the option of an aircraft file. With ``flies``, refuse a simulator that runs a program."""
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
