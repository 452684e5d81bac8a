"""Start of a flight test on a live link. The test is new, continues a recording, or takes over a running
link.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import click

from advisor.cli.options import NEWEST
from advisor.mavlink.link.kept_link import Keeping
from advisor.mavlink.link.link_process import LinkProcess, RunningLink, end, running_alone
from advisor.mavlink.link.recorder import default_recording, recordings_folder, writable_folder
from advisor.session.campaign_file import CampaignFile, read_campaign, write_campaign
from advisor.words.problems import ConfigurationError


@dataclass(frozen=True, slots=True)
class Start:
    """Connection, recording and earlier flights at the start of a flight test."""

    campaign: CampaignFile
    recording: Path | None
    """File of the recording; None if nothing is recorded."""
    goes_on: bool = False
    """Whether the recording exists and is appended to."""
    earlier: tuple[Path, ...] = ()
    """Logs of earlier flights of the campaign, which are only read."""


def start_of(
    asked: CampaignFile,
    resume: str | None,
    further: Sequence[Path],
    record_to: str | None,
    recorded: bool = True,
) -> Start:
    """Return the start of a flight test from the options of ``advisor live``.

    Parameters
    ----------
    asked
        Options of the command line. An empty ``master`` or None means that the option is not given.
    resume
        Recording whose flight test continues, or ``NEWEST``; None for a new flight test.
    further
        Recordings of the same flight test after the recording ``resume``.
    record_to
        File or folder of the recording. With None, the user's own folder or the flight test's last recording
        is used.

    Raises
    ------
    ConfigurationError
        A recording is missing, or no connection is known.
    """
    place = _in_folder(record_to)
    if resume is None:
        if not asked.master:
            raise ConfigurationError(
                "Missing option '--master': say where the vehicle is heard, e.g. "
                "--master udpin:0.0.0.0:14550."
            )
        if place is None and recorded:
            folder, said = writable_folder()
            place = default_recording(folder)
            if said:
                click.echo(said, err=True)
        return Start(asked, place)
    logs = [_newest(place.parent if place else None) if resume == NEWEST else Path(resume), *further]
    for log in logs:
        if not log.is_file():
            raise ConfigurationError(f"--resume: there is no recording {log}; see {recordings_folder()}.")
    before = read_campaign(logs[-1])
    campaign = _over(asked, before)
    if not campaign.master:
        raise ConfigurationError(
            f"--resume: no file of options next to {logs[-1]} says where the vehicle is heard; give --master."
        )
    if place is not None:
        return Start(campaign, place, earlier=tuple(_in_order(logs)))
    return Start(campaign, logs[-1], goes_on=True, earlier=tuple(_in_order(logs[:-1])))


@contextmanager
def started(start: Start, keeping: Keeping) -> Iterator[LinkProcess]:
    """Start the process of the link, or take over the running one. The process ends with the context.

    Raises
    ------
    UnusableInputError
        The connection cannot be opened, or the recording cannot be written or continued.
    """
    running = _left_alone(start)
    if running is not None:
        keeping = replace(keeping, door=running.door)
    with LinkProcess(keeping, running) as process:
        if process.recording is not None:
            _keep_options(process.recording, start.campaign)
        yield process


def _left_alone(start: Start) -> RunningLink | None:
    """Return the link that still records this flight test. End a running link of another flight test."""
    mine = None
    for running in running_alone():
        if start.goes_on and running.recording and _same(running.recording, start.recording):
            mine = running
        elif running.master == start.campaign.master:
            end(running)
            said = f"{running.master} was still open from an advisor that crashed. This link is now closed"
            again = f"; --resume {running.recording} continues its flight test" if running.recording else ""
            click.echo(said + again, err=True)
    return mine


def _in_order(logs: Sequence[Path]) -> list[Path]:
    from advisor.analysis.marks_file import LogSeries

    return LogSeries(logs).logs


def _same(a: Path, b: Path | None) -> bool:
    return b is not None and a.resolve() == b.resolve()


def _over(asked: CampaignFile, before: CampaignFile | None) -> CampaignFile:
    """Return the given options; an option that is not given takes its earlier value."""
    if before is None:
        return asked
    return CampaignFile(
        asked.master or before.master,
        asked.rule or before.rule,
        asked.target_system or before.target_system,
        before.aircraft if asked.aircraft is None else asked.aircraft,
    )


def _in_folder(place: str | None) -> Path | None:
    """Return the file of the recording. In a folder, the file's name is the time."""
    if place is None:
        return None
    is_folder = Path(place).is_dir() or place.endswith(("/", "\\"))
    return default_recording(Path(place)) if is_folder else Path(place)


def _newest(folder: Path | None) -> Path:
    folder = folder or recordings_folder()
    recordings = sorted(folder.glob("*.tlog"), key=lambda path: path.stat().st_mtime)
    if not recordings:
        raise ConfigurationError(f"--resume: there is no recording in {folder}; name one.")
    return recordings[-1]


def _keep_options(recording: Path, campaign: CampaignFile) -> None:
    try:
        write_campaign(recording, campaign)
    except OSError as error:
        click.echo(f"the options cannot be kept for --resume: {error.strerror or error}", err=True)
