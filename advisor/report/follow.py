"""Campaign without a screen, whose verdicts are printed as lines of text."""

from collections.abc import Callable, Iterator, Sequence

from advisor.campaign.being_flown import InputEnough
from advisor.campaign.campaign import Campaign, CampaignEvent, ManeuverJudged
from advisor.campaign.state import CampaignState
from advisor.decision.crew_plan import CrewPlan
from advisor.decision.verdict import FlightTestVerdict
from advisor.flight.maneuvers.events import (
    DataAgain,
    FlightBegan,
    ManeuverAgain,
    NoData,
    Notice,
    Rebooted,
    VehicleFound,
)
from advisor.flight.signals.messages import Columns
from advisor.report.facts.answers import next_line, stop_line
from advisor.report.table import SIDE_ROOM, maneuver_line
from advisor.words.digits import CLOCK, clock


def follow(
    batches: Iterator[Sequence[Columns]],
    campaign: Campaign,
    say: Callable[[str], object],
    of_log: bool = False,
) -> CampaignState:
    """Feed a campaign to the end of a stream and print every verdict.

    A log often begins with slow streams, which the crew corrects before the flight. An alarm about a log is
    therefore printed only after the log's data have been usable once.

    Parameters
    ----------
    batches
        Messages in order of arrival. Empty batches represent pauses.
    of_log
        Whether the stream is a log, in which nothing can be corrected.
    """
    begun = not of_log
    for columns in batches:
        for event in campaign.feed(columns):
            if begun or not isinstance(event, NoData | DataAgain):
                _say(event, say)
        begun = begun or campaign.serves
    for event in campaign.finish():
        _say(event, say)
    state = campaign.state
    side = state.lateral
    if side is not None and not side.maneuvers and side.flight_test.next is None:
        say(f"note: {side.flight_test.sentence}")
    for part in state.failed:
        say(part.sentence)
    return state


def _say(event: CampaignEvent, say: Callable[[str], object]) -> None:
    match event:
        case FlightBegan(_, name):
            say(f"{name}: times of this log count from its own power-on")
        case ManeuverAgain(maneuver, takes_place):
            better = ", with this better record" if takes_place else ""
            at = clock(maneuver.span.start_s)
            say(f"{maneuver.number:2d}  {at:>7}  is already recorded and counts once{better}")
        case InputEnough(number):
            say(f"ENOUGH: each derivative is within its tolerance in input {number} of the script")
        case VehicleFound(vehicle):
            say(f"following {vehicle}; times are {CLOCK}")
        case Rebooted(boot):
            say(f"power-on {boot + 1}: the vehicle's clock began anew, and times count from this power-on")
        case Notice(_, text):
            say(f"note: {text}")
        case NoData(problems):
            for problem in problems:
                say(f"NO DATA: {problem}")
        case DataAgain():
            say("DATA AGAIN: what arrives can serve.")
        case ManeuverJudged(judged, verdict, plan, axis, revised):
            side = axis == "lateral"
            say(f"{maneuver_line(judged, SIDE_ROOM)}  (roll and yaw)" if side else maneuver_line(judged))
            for said in revised:
                say(f"    CHANGED: {said}")
            _say_decision(verdict, plan, say)


def _say_decision(verdict: FlightTestVerdict, plan: CrewPlan | None, say: Callable[[str], object]) -> None:
    """Print stop or continue and the next input. After one axis is complete, print both axes."""
    if plan is not None and plan.done:
        say(f"    {plan.announced}")
        say(f"    {plan.advice}")
    else:
        say(f"    {stop_line(verdict)}")
        say(f"    {next_line(verdict)}")
