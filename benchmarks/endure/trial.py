"""One case answered in this process, and what is wrong with the answer."""

import io
import json
import os
import re
import resource
import signal
import sys
import tempfile
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any
from unittest.mock import patch

from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.marks_file import LogSeries
from advisor.campaign.campaign import Campaign
from advisor.cli import group as cli
from advisor.process.parts import INTERNAL
from advisor.report.document import analysis_document
from advisor.session.conducting import SessionReport
from advisor.session.conductor import Conductor
from advisor.session.replay import LogPlayer
from advisor.words.problems import UnusableInputError
from benchmarks.endure.cases import Case
from benchmarks.remedies import contradictions, verdicts_of

UNUSABLE = 3
SOUND_CODES = (0, UNUSABLE)
S_A_MINUTE, LEAST_S = 20.0, 20.0
"""Processor time that an answer may take, s for each minute of log, and the least limit, s."""
LONGEST_S = 3600.0
"""Longest limit of one case, s."""
HANGS = 60.0
"""Wall time after which an answer hangs, as a multiple of its processor time. A loaded machine is slow."""


class TooLong(BaseException):
    """The answer takes longer than its limit. No handler of errors in the advisor catches this one."""


@dataclass(frozen=True)
class Failure:
    """What is wrong with an answer."""

    kind: str
    """Kind by which failures are counted, with the place of the fault where there is one."""
    told: str = ""
    """Traceback, or the end of what the command wrote on standard error."""


def failure(case: Case) -> Failure | None:
    """Answer a case; return what is wrong with the answer, if anything."""
    data, long_s = case.made()
    limit_s = max(LEAST_S, S_A_MINUTE * long_s / 60.0)
    out, err = io.StringIO(), io.StringIO()
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / Path(case.log.removesuffix(".xz")).name
        log.write_bytes(data)
        began_s = _children_s()
        try:
            with limited(limit_s), redirect_stdout(out), redirect_stderr(err):
                code = _live(log, case.aircraft) if case.command == "live" else _command(case, log)
        except TooLong as late:
            return Failure(
                f"too long, at {_place(late)}", f"more than {limit_s:.0f} s of {long_s:.0f} s of log"
            )
        except UnusableInputError:
            code = UNUSABLE  # the command raises this one where a traceback is asked for
        except Exception as fault:
            return Failure(f"exit 70: {type(fault).__name__} at {_place(fault)}", traceback.format_exc())
        spent_s = _children_s() - began_s
    if spent_s > limit_s:
        return Failure("too long, in processes", f"{spent_s:.0f} s of {limit_s:.0f} s")
    return judged(code, out.getvalue(), err.getvalue())


def judged(code: int, out: str, err: str) -> Failure | None:
    """Return what is wrong with an exit code, a document and what stands on standard error."""
    if code not in SOUND_CODES:
        return Failure(f"exit {code}", err[-2000:])
    try:
        document = json.loads(out, parse_constant=_refuse)
    except ValueError as error:
        return Failure(f"document: {str(error)[:60]}", err[-2000:])
    broken = [one["part"] for one in _problems(document) if one.get("code") == INTERNAL]
    if broken:
        kind = re.sub(r"\d+", "N", str(broken[0]))
        places = re.findall(r'File ".*?((?:advisor|scipy|numpy)/[^"]*)", line (\d+)', err)
        return Failure(f"internal: {kind} at {':'.join(places[-1]) if places else '?'}", err[-3000:])
    if "Traceback" in err:
        return Failure("traceback on standard error", err[-3000:])
    said = next((text for one in verdicts_of(document) for text in contradictions(one)), None)
    return None if said is None else Failure(f"advice: {said.partition(':')[0]}", said)


def _refuse(token: str) -> float:
    raise ValueError(f"{token} in the document")


def _problems(document: Any) -> Iterator[dict[str, Any]]:
    """Yield every problem, reason and refusal of a document, at whatever depth."""
    if isinstance(document, dict):
        if document.get("code") == INTERNAL:
            yield {"part": str(document.get("text"))[:40], **document}
        for one in document.values():
            yield from _problems(one)
    elif isinstance(document, list):
        for one in document:
            yield from _problems(one)


def _command(case: Case, log: Path) -> int:
    words = ["advisor", case.command, str(log), "--json"]
    words += ["--aircraft", str(case.aircraft)] if case.aircraft else []
    with patch.object(sys, "argv", words), patch.dict(os.environ, ADVISOR_TRACEBACK="1"):
        try:
            cli.main()
        except SystemExit as end:
            return int(end.code or 0)
    return 0


def _live(log: Path, aircraft_file: Path | None) -> int:
    """Play a log as fast as possible through the core of a live flight, and print the document of its end."""
    aircraft = load_aircraft(aircraft_file)
    series = LogSeries([log])
    player = LogPlayer(log.name, series.load, inf)
    conductor = Conductor(player, lambda by_hand: Campaign(aircraft, by_hand=by_hand, lateral=True))
    last: list[SessionReport] = []

    def tell(report: SessionReport) -> None:
        last[:] = [report]
        if report.health.condition == "ended":
            conductor.stop()

    try:
        conductor.run(tell)
    except UnusableInputError as error:
        print(json.dumps(analysis_document(None, [str(log)], aircraft, {0: error.problems}), allow_nan=False))
        return UNUSABLE
    state = last[-1].state
    sys.stderr.writelines(part.trace for part in state.failed)
    print(json.dumps(analysis_document(state, [str(log)], aircraft, {}), allow_nan=False))
    return 0


@contextmanager
def limited(limit_s: float) -> Iterator[None]:
    """End what takes longer than a limit of this process's processor time.

    A log whose clock is wild has a limit that no timer takes, so an hour is the longest.
    """
    limit_s = min(limit_s, LONGEST_S)

    def late(number: int, frame: object) -> None:
        raise TooLong

    clocks = {
        signal.ITIMER_PROF: (signal.SIGPROF, limit_s),
        signal.ITIMER_REAL: (signal.SIGALRM, HANGS * limit_s),
    }
    before = {number: signal.signal(number, late) for number, _ in clocks.values()}
    others = {clock: signal.setitimer(clock, after_s) for clock, (_, after_s) in clocks.items()}
    try:
        yield
    finally:
        for clock, (number, _) in clocks.items():
            signal.setitimer(clock, 0.0)
            signal.signal(number, before[number])
            signal.setitimer(clock, *others[clock])


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _place(error: BaseException) -> str:
    """Return the innermost line of the advisor that an error passed."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if "/advisor/" in f.filename]
    return f"{frames[-1].filename.rpartition('/advisor/')[2]}:{frames[-1].lineno}" if frames else "?"
