"""``advisor live``: advice on a live link."""

import shlex
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.cli.options import NEWEST, LogsAsked, log_options
from advisor.cli.screen import Show, advise, headless
from advisor.process.interrupt import STOPPED, in_order
from advisor.words.problems import ConfigurationError, printable

if TYPE_CHECKING:
    from advisor.campaign.campaign import ManeuverJudged
    from advisor.campaign.state import ByHand
    from advisor.mavlink.link.announce import Announcer
    from advisor.mavlink.link.kept_link import KeptLink
    from advisor.session.conducting import Source


@click.command
@log_options("rule", "no_marks", required=False)
@click.option(
    "--master",
    metavar="CONN",
    help="Connection, as in pymavlink: udpin:0.0.0.0:14550, tcp:host:port, /dev/ttyUSB0,57600.",
)
@click.option("--record", "record_to", metavar="FILE|DIR", help="File or folder for the recording.")
@click.option("--no-record", is_flag=True, help="Keep no recording of the link.")
@click.option(
    "--resume",
    is_flag=False,
    flag_value=NEWEST,
    metavar="[REC]",
    help="Continue the flight test of a recording (default: the newest), with its options unless given anew.",
)
@click.option(
    "--request-rates", is_flag=True, help="Ask the vehicle for streams of 50 Hz and its servo parameters."
)
@click.option(
    "--announce",
    is_flag=True,
    help="Send each verdict and TEST COMPLETE to the ground stations (STATUSTEXT).",
)
@click.option(
    "--announce-to",
    metavar="CONN",
    help="Send the announcements to this connection instead, e.g. to a --master of MAVProxy.",
)
@click.option(
    "--uplink",
    is_flag=True,
    help="Send each advised input to the script of advisor script, and the end of a multisine whose data are "
    "enough, as SCR_USER1 to 4; nothing else is sent.",
)
@click.option(
    "--signing-key",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="File with a key: sign sent packets, and refuse packets without its signature.",
)
def command(
    asked: LogsAsked,
    master: str | None,
    record_to: str | None,
    no_record: bool,
    resume: str | None,
    request_rates: bool,
    announce: bool,
    announce_to: str | None,
    uplink: bool,
    signing_key: Path | None,
    show: Show | None = None,
) -> None:
    """Advise during a flight. Nothing is sent to the vehicle unless an option here asks for it.

    The link and its recording run in a separate process. If the advisor ends unexpectedly, the recording
    continues in that process, and --resume continues the flight test. Without a terminal, or with HEADLESS=1,
    the verdicts come as text.

    \b
    Example:
      advisor live --master udpin:0.0.0.0:14550 --aircraft my-aircraft.yaml
      advisor live --master /dev/ttyUSB0,57600 --request-rates --announce
      advisor live --resume
    """
    if no_record and (record_to is not None or resume is not None):
        other = "--record" if record_to is not None else "--resume"
        raise ConfigurationError(f"{other} and --no-record contradict each other; give one of them.")
    if asked.logs and resume is None:
        raise ConfigurationError(_without_resume(str(asked.logs[0])))
    from advisor.campaign.state import NOTHING
    from advisor.cli.flight_start import start_of, started
    from advisor.mavlink.link.kept_link import Keeping, new_door
    from advisor.mavlink.link.transports import parse_connection
    from advisor.mavlink.wire.framing import read_key
    from advisor.process.yaml_file import read_yaml
    from advisor.session.campaign_file import CampaignFile

    content = read_yaml(asked.aircraft_file) if asked.aircraft_file else None
    wanted = CampaignFile(master or "", asked.rule, asked.target_system, content)
    start = start_of(wanted, resume, asked.logs, record_to, recorded=not no_record)
    for connection in filter(None, (start.campaign.master, announce_to)):
        parse_connection(connection)
    aircraft = start.campaign.parsed_aircraft(str(asked.aircraft_file or start.recording))
    # A recording that exists and is not taken up is another flight's, and so are the decisions on it.
    mine = start.goes_on or not (start.recording and start.recording.exists())
    by_hand = NOTHING if asked.no_marks else _decided((*start.earlier, start.recording if mine else None))
    keeping = Keeping(
        start.campaign.master, new_door(), start.campaign.target_system, start.recording,
        start.goes_on, read_key(signing_key) if signing_key else None, request_rates,
        announce or announce_to is not None, announce_to, uplink,
    )  # fmt: skip
    recordings: list[Path] = []
    with in_order(partial(_ended, recordings)), started(start, keeping) as process:
        recordings += [process.recording] if process.recording else []
        click.echo(_recorded(recordings), err=True)
        link = process.link(aircraft.elevator)
        advise(
            partial(_source, start.earlier, link),
            start.campaign.master,
            aircraft,
            start.campaign.target_system,
            partial(_tell, link, keeping.announce, uplink) if keeping.announce or uplink else None,
            by_hand=by_hand,
            kept=partial(_decided, (*start.earlier, process.recording)),
            names=[*(printable(log.name) for log in start.earlier), start.campaign.master],
            logs=[*start.earlier, *recordings],
            show=show,
            aircraft_file=asked.aircraft_file,
            door=process.door,
        )
    if recordings and show is None and not headless():
        click.echo(_page((*start.earlier, *recordings), asked.aircraft_file), err=True)


def _without_resume(given: str) -> str:
    """Return the error for an argument: a connection without its option, or a log without --resume."""
    from advisor.mavlink.link.transports import parse_connection

    try:
        parse_connection(given)
    except ConfigurationError:
        return "LOG needs --resume, which continues the flight test of these logs."
    return f"Name the connection by its option: advisor live --master {given}"


def _recorded(recordings: Sequence[Path]) -> str:
    return f"recording to {printable(str(recordings[0]))}" if recordings else "nothing is recorded"


def _page(logs: Sequence[Path], aircraft_file: Path | None) -> str:
    """Return the sentence with the command that writes the page of the flight."""
    command = ["advisor", "report", *map(str, logs), "-o", "flight.html"]
    if aircraft_file:
        command += ["--aircraft", str(aircraft_file)]
    return f"The page of the flight: {printable(shlex.join(command))}"


def _ended(recordings: Sequence[Path]) -> str:
    """Return the sentence that the crew reads when a signal ends the command."""
    return f"Stopped; the recording is {printable(str(recordings[0]))}." if recordings else STOPPED


def _decided(flights: Sequence[Path | None]) -> "ByHand":
    """Return the decisions by hand on these flights. Without a recording, nothing is kept."""
    from advisor.analysis.marks_file import read_by_hand
    from advisor.campaign.state import NOTHING, on_all

    return on_all([read_by_hand(flight) if flight else NOTHING for flight in flights])


def _source(earlier: Sequence[Path], link: "KeptLink") -> "Source":
    from advisor.session.live import LinkSource
    from advisor.session.replay import ResumedSource

    return ResumedSource(earlier, LinkSource(link)) if earlier else LinkSource(link)


def _tell(link: "KeptLink", announce: bool, uplink: bool, event: object) -> None:
    """Announce a verdict to the ground stations, and send the next input to the autopilot's script."""
    from advisor.campaign.campaign import ManeuverJudged
    from advisor.campaign.single_maneuver import InputEnough

    if uplink and isinstance(event, InputEnough):
        from advisor.scripts.table import end_order

        link.advise(*end_order(event.number))
    if not isinstance(event, ManeuverJudged):
        return
    if uplink:
        from advisor.scripts.table import next_order

        test, plan = event.flight_test, event.plan
        advised, is_open = (
            (test.next, test.decision != "stop") if plan is None else (plan.next, not plan.is_complete)
        )
        if is_open and advised is not None and advised.input is not None:
            link.advise(*next_order(advised.input))
    if announce:
        _announce(link, event)


def _announce(to: "KeptLink | Announcer", event: "ManeuverJudged") -> None:
    """Announce the verdict on a manoeuvre, and the plan of all axes that are flown."""
    verdict, plan = event.flight_test, event.plan
    axis = "roll and yaw" if event.axis == "lateral" else ""
    stop = verdict.sentence if verdict.decision == "stop" else ""
    stop, about = (stop, axis) if plan is None else (plan.announced, plan.announced)
    to.judged(event.judged.maneuver.number, event.judged.verdict.sentence, stop, axis, about)
