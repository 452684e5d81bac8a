"""The server of the Model Context Protocol: four read-only tools over the advisor's commands, on files of
given folders.
"""

import json
from collections.abc import Awaitable, Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from subprocess import DEVNULL
from tempfile import TemporaryDirectory
from typing import Any

from anyio import CapacityLimiter, fail_after, run_process
from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations

from advisor import __version__
from advisor.aircraft_file.read import load_aircraft
from advisor.mavlink.logs.formats import ENDINGS
from advisor.process.children import python_module
from advisor.words.problems import ConfigurationError

LOGS = (*ENDINGS, ".zip", ".gz", ".log", ".raw")
"""Endings of the files that are listed as logs."""


class RefusedError(Exception):
    """A file that the assistant may not read. The exception's message is for the assistant."""


@dataclass(frozen=True, slots=True)
class Folders:
    """Folders that an assistant may read."""

    roots: tuple[Path, ...]
    """Paths of the folders with links resolved."""
    most_bytes: int
    """Size of the largest file that an assistant may read, bytes."""

    def file(self, name: str) -> Path:
        """Return a file inside the folders, with links resolved.

        Parameters
        ----------
        name
            Absolute path, or path relative to one of the folders.

        Raises
        ------
        RefusedError
            The path leaves the folders, names no file, or the file is too large.
        """
        if not name.strip():
            raise RefusedError(
                "The name of the file is empty: give a path inside the folders of this server."
            )
        if "\0" in name:
            raise RefusedError("The name of the file holds a zero byte, which no path may hold.")
        try:
            return self._file(name)
        except (OSError, RuntimeError) as error:  # a name too long, a folder that may not be read, a loop
            why = error.strerror if isinstance(error, OSError) else "its links lead in a circle"
            raise RefusedError(f"{name[:100]} cannot be read: {why}.") from None

    def _file(self, name: str) -> Path:
        candidates = [(root / name).resolve() for root in self.roots]
        inside = [path for path in candidates if any(path.is_relative_to(root) for root in self.roots)]
        if not inside:
            raise RefusedError(f"{name} lies outside the folders of this server: {self.listed}.")
        file = next((path for path in inside if path.is_file()), None)
        if file is None:
            other = next((path for path in inside if path.exists()), None)
            if other is None:
                raise RefusedError(f"There is no file {name} in {self.listed}.")
            kind = "a folder: name a log in it" if other.is_dir() else "a pipe, socket or device, not a file"
            raise RefusedError(f"{name} is {kind}.")
        size = file.stat().st_size
        if size > self.most_bytes:
            most = _amount(self.most_bytes)
            raise RefusedError(f"{name} has {_amount(size)}, and this server reads at most {most}.")
        return file

    @property
    def listed(self) -> str:
        return ", ".join(map(str, self.roots))

    def logs(self) -> Iterator[Path]:
        """Yield the files in the folders that look like logs, in the order of their names."""
        for root in self.roots:
            files = (path for path in root.rglob("*") if path.suffix.lower() in LOGS and path.is_file())
            yield from sorted(path for path in files if path.resolve().is_relative_to(root))


def _amount(count: int) -> str:
    """Return a number of bytes in words, in the largest suitable unit."""
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= size:
            return f"{count / size:.{0 if count >= 10.0 * size else 1}f} {unit}".replace(".0 ", " ")
    return f"{count} bytes"


def folders_of(roots: Sequence[Path], most_bytes: int) -> Folders:
    """Return the folders of a command line, with links resolved."""
    return Folders(tuple(root.resolve() for root in roots), most_bytes)


class Calls:
    """Runs the advisor's commands, one at a time.

    Parameters
    ----------
    limit_s
        Time after which a command is ended, s.
    """

    def __init__(self, limit_s: float) -> None:
        self._limit_s = limit_s
        self._one = CapacityLimiter(1)

    async def document(self, arguments: Sequence[str]) -> dict[str, Any]:
        """Return the document that a command prints with ``--json``, for an unusable log too.

        Raises
        ------
        RefusedError
            The command fails, takes too long, or prints too much.
        """
        code, printed, said = await self._run([*arguments, "--json"])
        if not printed:
            raise RefusedError(said or f"advisor {arguments[0]} ended with exit code {code}.")
        document: dict[str, Any] = json.loads(printed)
        return document

    async def done(self, arguments: Sequence[str]) -> None:
        """Run a command that writes a file.

        Raises
        ------
        RefusedError
            The advisor's command fails or takes too long.
        """
        code, _, said = await self._run(arguments)
        if code:
            raise RefusedError(said or f"advisor {arguments[0]} ended with exit code {code}.")

    async def _run(self, arguments: Sequence[str]) -> tuple[int, bytes, str]:
        """Return exit code, standard output and the last line on standard error of a command."""
        words = [*python_module("advisor"), *arguments]
        try:
            async with self._one:
                with fail_after(self._limit_s):
                    done = await run_process(words, stdin=DEVNULL, check=False)
        except TimeoutError:
            limit = f"{self._limit_s:.0f} s"
            raise RefusedError(f"advisor {arguments[0]} was ended after {limit}, the limit here.") from None
        # Progress and warnings come first, the sentence on the failure last.
        said = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        return done.returncode, done.stdout, said


MOST_BYTES = 20_000
"""Longest answer as sent, bytes: some 7,000 tokens, a small share of an assistant's context."""
_ENVELOPE_BYTES = 200
"""Largest size of the protocol's data around an answer's text, bytes, with the number of the request."""
_LEAST_BYTES = 200
"""Least size, bytes, to which a part of an answer is shortened. A part that would become smaller is
omitted."""
_ITEM_BYTES = 800
"""Least size of a list item, bytes: one manoeuvre with its verdict and reasons. Later items of the list are
omitted."""
_DIGITS = 7
"""Number of significant digits in an answer. A time of one hour thus keeps its milliseconds."""


def part_of(document: Any, path: str) -> Any:
    """Return a part of a document.

    Parameters
    ----------
    path
        Keys and list positions with dots between: ``lateral.maneuvers.2``. Empty: the whole document.

    Raises
    ------
    RefusedError
        The document has no such part.
    """
    part = document
    for step in filter(None, path.split(".")):
        if isinstance(part, dict) and step in part:
            part = part[step]
        elif isinstance(part, list) and step.isdigit() and int(step) < len(part):
            part = part[int(step)]
        else:
            there = ", ".join(part) if isinstance(part, dict) else f"0 to {len(part) - 1}"
            if not isinstance(part, dict | list) or not part:
                there = "nothing"
            raise RefusedError(f"There is no part {path}: at {step} there are {there}.")
    return part


def written(document: Any, path: str = "", without: Sequence[str] = ()) -> str:
    """Return a document, or its part at ``path``, as JSON of at most ``MOST_BYTES``.

    The largest parts of the document are shortened first. A sentence in the place of a part names the path to
    ask for.

    Parameters
    ----------
    without
        Keys of the document and of its blocks that only a request by path answers.
    """
    whole = _rounded(part_of(document, path))
    if not path:
        whole = _on_request(whole, without)
    budget = MOST_BYTES
    while not fits(text := _json(_shortened(whole, budget, path))):
        budget = budget * 9 // 10
    return text


def _on_request(value: Any, without: Sequence[str], within: str = "") -> Any:
    """Return a document without the keys that only a request answers; ``within`` is the path to it."""
    if not isinstance(value, dict):
        return value
    return {
        k: _left_out(v, f"{within}{k}") if k in without and v else _on_request(v, without, f"{within}{k}.")
        for k, v in value.items()
    }


def fits(text: str) -> bool:
    """Return whether an answer with this text, which the protocol sends as a JSON string, is short enough."""
    return len(_json(text).encode()) <= MOST_BYTES - _ENVELOPE_BYTES


def _shortened(value: Any, budget: int, path: str) -> Any:
    """Return a value shortened to a size in bytes: small parts stay complete, large ones are shortened."""
    if _size(value) <= budget:
        return value
    if budget < _LEAST_BYTES:
        return _left_out(value, path)
    if isinstance(value, dict):
        return _shared(value, budget, path)
    if isinstance(value, list):
        kept: list[Any] = []
        for k, item in enumerate(value):
            share = max(budget // (len(value) - k), _ITEM_BYTES)
            shorter = _shortened(item, share, f"{path}.{k}".lstrip("."))
            budget -= _size(shorter)
            if budget < _LEAST_BYTES:
                return [*kept, f"{len(value) - k} more; ask for part {path}.{k} and so on".replace(" .", " ")]
            kept.append(shorter)
        return kept
    return _left_out(value, path)


def _shared(value: dict[str, Any], budget: int, path: str) -> dict[str, Any]:
    shorter = {}
    by_size = sorted(value, key=lambda key: _size(value[key]))
    for k, key in enumerate(by_size):
        share = budget // (len(by_size) - k)
        shorter[key] = _shortened(value[key], share, f"{path}.{key}".lstrip("."))
        budget -= _size(shorter[key]) + len(key) + 4
    return {key: shorter[key] for key in value}


def _left_out(value: Any, path: str) -> str:
    return f"left out, {_size(value) / 1000.0:.1f} kB; ask for part {path}"


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{_DIGITS}g}")
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list) else value


def _size(value: Any) -> int:
    return len(_json(value).encode())


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


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
