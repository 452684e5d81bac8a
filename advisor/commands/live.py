"""``advisor live``: advise on a live link."""

from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

import click

from advisor.aircraft import Rule
from advisor.commands.options import (
    aircraft_option,
    decided_on,
    no_marks_option,
    read_aircraft,
    rule_option,
    target_system_option,
)
from advisor.commands.screen import advise
from advisor.interrupt import STOPPED, in_order
from advisor.printable import printable
from advisor.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.mavlink.announce import Announcer
    from advisor.mavlink.link import Link


@click.command
@click.option(
    "--master",
    required=True,
    metavar="CONN",
    help="Connection, as in pymavlink: udpin:0.0.0.0:14550, tcp:host:port, /dev/ttyUSB0,57600.",
)
@click.option(
    "--record", "record_to", type=click.Path(path_type=Path), metavar="FILE", help="Recording's file."
)
@click.option("--no-record", is_flag=True, help="Keep no recording of the link.")
@click.option("--request-rates", is_flag=True, help="Ask the vehicle for 50 Hz streams and its servo set-up.")
@click.option(
    "--announce", is_flag=True, help="Send each verdict and STOP to the ground stations (STATUSTEXT)."
)
@click.option(
    "--signing-key",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Sign what is sent, refuse what is not signed with this key.",
)
@click.option(
    "--source-system", type=click.IntRange(1, 255), default=254, show_default=True, help="Own system id."
)
@aircraft_option
@rule_option
@target_system_option
@no_marks_option
def command(
    master: str,
    record_to: Path | None,
    no_record: bool,
    request_rates: bool,
    announce: bool,
    signing_key: Path | None,
    source_system: int,
    aircraft_file: Path | None,
    rule: Rule | None,
    target_system: int | None,
    no_marks: bool,
) -> None:
    """Advise while flying. Nothing is sent to the vehicle unless an option here asks for it.

    Without a terminal, or with HEADLESS=1, the verdicts come as text.

    \b
    Example:
      advisor live --master udpin:0.0.0.0:14550 --aircraft my-aircraft.yaml
      advisor live --master /dev/ttyUSB0,57600 --request-rates --announce
    """
    if no_record and record_to is not None:
        raise ConfigurationError("--record and --no-record contradict each other; give one of them.")
    aircraft = read_aircraft(aircraft_file, rule)
    # A recording that exists is not overwritten: what was decided on it belongs to another flight.
    is_new = record_to is not None and not record_to.exists()
    by_hand = decided_on(record_to, no_marks) if record_to is not None and is_new else None
    from advisor.mavlink.announce import Announcer
    from advisor.mavlink.connection import parse_connection
    from advisor.mavlink.signing import read_key
    from advisor.tui.live import LinkSource

    parse_connection(master)
    announcer = Announcer() if announce else None
    connection = _Connection(
        master,
        source_system,
        target_system,
        record_to,
        recorded=not no_record,
        key=read_key(signing_key) if signing_key else None,
        request_rates=request_rates,
        announcer=announcer,
    )
    tell = partial(_announce, announcer) if announcer else None
    with in_order(connection.ended), ExitStack() as at_the_end:
        # Once more than the source does: a signal may come while the connection is being opened.
        at_the_end.push(connection)
        advise(partial(LinkSource, connection), master, aircraft, target_system, tell, by_hand=by_hand)


@dataclass
class _Connection(AbstractContextManager["Link"]):
    """A link as the options describe it; nothing is loaded or opened before it is entered."""

    master: str
    source_system: int
    target_system: int | None
    record_to: Path | None
    recorded: bool
    key: bytes | None
    request_rates: bool
    announcer: "Announcer | None"
    _link: "Link | None" = field(default=None, init=False)

    def ended(self) -> str:
        """What the user is told when a signal ends the command."""
        recording = self._link.statistics.recording if self._link is not None else None
        return STOPPED if recording is None else f"Stopped; the recording is {printable(str(recording))}."

    def __enter__(self) -> "Link":
        from advisor.mavlink.inquiry import Inquiry
        from advisor.mavlink.link import Link
        from advisor.mavlink.outgoing import Talker
        from advisor.mavlink.rates import STREAMS, RateRequest
        from advisor.mavlink.recorder import default_recording

        talkers: list[Talker] = [self.announcer] if self.announcer else []
        if self.request_rates:
            talkers += [RateRequest(dict.fromkeys(STREAMS, 50.0)), Inquiry()]
        self._link = Link(
            self.master,
            source_system=self.source_system,
            target_system=self.target_system,
            record_to=self.record_to or default_recording() if self.recorded else None,
            key=self.key,
            talkers=talkers,
        )
        return self._link.start()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._link is not None:
            self._link.stop()


def _announce(announcer: "Announcer", event: object) -> None:
    from advisor.campaign import ManeuverJudged

    if isinstance(event, ManeuverJudged):
        verdict = event.flight_test
        stop = verdict.sentence if verdict.decision == "stop" else None
        announcer.judged(event.judged.maneuver.number, event.judged.verdict.sentence, stop)
