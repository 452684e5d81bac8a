"""Content of the page of ``advisor report``: logs heard as one campaign, telemetry examined, gap
diagnosed."""

import hashlib
import platform
import shlex
import sys
from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

from advisor import __version__
from advisor.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.hand_decisions import NOTHING, ByHand
from advisor.campaign.state import CampaignState
from advisor.commands.doctor import examine_log
from advisor.diagnosis import compare_logs, named_simulator
from advisor.doctor.document import doctor_document
from advisor.gap.document import gap_document
from advisor.log_series import LogSeries
from advisor.printable import printable
from advisor.problems import Problem, UnusableInputError
from advisor.report.document import analysis_document
from advisor.report.page.content import Content, Document, Origin
from advisor.report.page.course import Course, CourseWatch, slices

_COUNTED = ("numpy", "scipy", "matplotlib", "jinja2", "pymavlink")
"""Libraries that numbers and pictures depend on; the page lists their versions."""


def gather(
    logs: Sequence[Path],
    aircraft: Aircraft,
    aircraft_file: Path | None,
    target_system: int | None,
    no_marks: bool,
    with_gap: bool,
) -> tuple[Content, list[str]]:
    """Return the content of the page, and sentences on logs that do not count.

    Raises
    ------
    UnusableInputError
        No log can be used.
    ConfigurationError
        As :func:`advisor.marks_file.read_by_hand`.
    """
    series = LogSeries(logs)
    by_hand = NOTHING if no_marks else series.read_by_hand()
    state, courses, left_out = _heard(series, aircraft, target_system, by_hand)
    said = [series.order_said] if series.order_said else []
    for flight, found in sorted(left_out.items()):
        said += [problem.about(series.names[flight]) for problem in found]
    if state is None or len(left_out) == len(series.logs):
        raise UnusableInputError.of([p for _, found in sorted(left_out.items()) for p in found])
    content = Content(
        state=state,
        analysis=analysis_document(state, [str(log) for log in series.logs], aircraft, left_out, said),
        names=tuple(map(printable, series.names)),
        aircraft=aircraft,
        courses=courses,
        doctor=tuple(_examined(log, aircraft, target_system) for log in series.logs),
        gap=_gap(series, left_out, aircraft, target_system, by_hand) if with_gap else None,
        origin=Origin(
            _hashes(series, aircraft_file),
            dict(_versions()),
            printable(shlex.join(["advisor", *sys.argv[1:]])),
        ),
    )
    return content, said


def _heard(
    series: LogSeries, aircraft: Aircraft, target_system: int | None, by_hand: ByHand
) -> tuple[CampaignState | None, tuple[Course, ...], Mapping[int, tuple[Problem, ...]]]:
    """Return the campaign at the end of its logs, the time histories of its flights, and reasons for which
    logs do not count, by flight."""
    campaign = Campaign(aircraft, target_system, by_hand=by_hand, names=series.names)
    watch = CourseWatch(campaign)
    for batch in series.batches():
        for piece in slices(batch):
            campaign.feed(piece)
            watch.look()
    unreadable = {flight: (problem,) for flight, problem in series.unreadable.items()}
    if len(unreadable) == len(series.logs):
        return None, (), unreadable
    campaign.finish()
    state = campaign.state
    unfit = {one.flight: one.problems for one in state.flights if one.problems}
    return state, watch.courses, unfit | unreadable


def _examined(log: Path, aircraft: Aircraft, target_system: int | None) -> Document:
    try:
        return doctor_document(examine_log(log, aircraft, target_system))
    except UnusableInputError as error:
        return doctor_document(None, error.problem)


def _gap(
    series: LogSeries,
    left_out: Mapping[int, object],
    aircraft: Aircraft,
    target_system: int | None,
    by_hand: ByHand,
) -> Document:
    usable = [flight for flight in range(len(series.logs)) if flight not in left_out]
    logs, decided = [series.logs[f] for f in usable], [by_hand.on_flight(f) for f in usable]
    simulator = None
    try:
        simulator = named_simulator(aircraft, target_system)
        compared = compare_logs(logs, aircraft, simulator, target_system=target_system, by_hand=decided)
    except UnusableInputError as error:
        return gap_document(None, error.problems)
    finally:
        if simulator is not None:
            simulator.close()
    return gap_document(compared.diagnosis)


def _hashes(series: LogSeries, aircraft_file: Path | None) -> Mapping[str, str]:
    """Return the SHA-256 of every input file, by the file's name."""
    named = [*zip(series.names, series.logs, strict=True)]
    named += [(aircraft_file.name, aircraft_file)] if aircraft_file else []
    return {printable(name): _sha256(path) for name, path in named if path.is_file()}


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _versions() -> Iterator[tuple[str, str]]:
    yield "inflight-advisor", __version__
    yield "Python", platform.python_version()
    yield from ((name, version(name)) for name in _COUNTED)
