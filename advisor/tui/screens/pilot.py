"""The pilot's screen, which shows one word to be read at a glance."""

from math import degrees, isfinite

from textual.app import ComposeResult
from textual.events import Resize

from advisor.session.conducting import View
from advisor.tui.advice import advise
from advisor.tui.panes.last_verdict import LastVerdict
from advisor.tui.panes.pane import Lines, Part
from advisor.tui.panes.pilot import BigWord, CrewNotes, Gauge, NextInput, Why
from advisor.tui.screens.face import Alarm, Ask, Face, KeysLine, ReplayBar, StatusLine

_APART = "    "


class LimitsNow(Part, Lines):
    """Line with the present values and limits, which a pilot reads before the first step."""

    def show(self, view: View) -> None:
        """Write the newest values of bank, air speed and angle of attack. A value outside its limit is marked
        by a cross."""
        complete = advise(view).word == "TEST COMPLETE"
        self.write("before it   nothing is left to fly" if complete else f"before it   {limits_now(view)}")


def limits_now(view: View) -> str:
    """Return bank, air speed and angle of attack with their limits, as far as they are received.

    The air speed is compared with the joint estimate's air speed, or with the aircraft file's.
    """
    limits = view.aircraft.limits
    said = [
        _of_bank(_bank_rad(view), limits.bank_deg),
        _of_speed(_airspeed_m_s(view), _speed_of_tests(view), limits.airspeed_change_percent),
        _of_alpha(_newest(view, "alpha"), limits.alpha_deg),
    ]
    return _APART.join(filter(None, said)) or "bank, air speed and angle of attack are not received"


def _bank_rad(view: View) -> float | None:
    """Return the bank, rad, from the link, else from the campaign; None if no bank is received."""
    link = view.health.link
    return link.bank_rad if link is not None and isfinite(link.bank_rad) else _newest(view, "bank")


def _airspeed_m_s(view: View) -> float | None:
    """Return the air speed, m/s, from the campaign, else from the link; None if no air speed is received."""
    link = view.health.link
    late = view.health.behind or "airspeed" not in view.state.channels
    if late and link is not None and isfinite(link.airspeed_m_s):
        return link.airspeed_m_s
    return _newest(view, "airspeed")


def _newest(view: View, name: str) -> float | None:
    """Return the campaign's newest value of a channel; None if the value is not received, or too old."""
    if view.health.behind:
        return None
    status = view.state.channels.get(name)
    return status.newest if status is not None and isfinite(status.newest) else None


def _speed_of_tests(view: View) -> float | None:
    model = view.state.model
    flown = model.airspeed_m_s if model is not None else None
    return flown or view.aircraft.stated_airspeed_m_s


def _of_bank(bank_rad: float | None, limit_deg: float) -> str:
    if bank_rad is None:
        return ""
    bank_deg = abs(degrees(bank_rad))
    return f"{_mark(bank_deg <= limit_deg)} bank {bank_deg:.0f} deg (≤ {limit_deg:.0f})"


def _of_speed(speed_m_s: float | None, tests_m_s: float | None, limit_percent: float) -> str:
    if speed_m_s is None:
        return ""
    if tests_m_s is None:
        return f"V {speed_m_s:.0f} m/s"
    change_m_s = 0.01 * limit_percent * tests_m_s
    low, high = tests_m_s - change_m_s, tests_m_s + change_m_s
    return f"{_mark(low <= speed_m_s <= high)} V {speed_m_s:.0f} m/s ({low:.0f} to {high:.0f})"


def _of_alpha(alpha_rad: float | None, limit_deg: float | None) -> str:
    if alpha_rad is None:
        return ""
    alpha_deg = degrees(alpha_rad)
    if limit_deg is None:
        return f"α {alpha_deg:.0f} deg"
    return f"{_mark(alpha_deg <= limit_deg)} α {alpha_deg:.0f} deg (≤ {limit_deg:.0f})"


def _mark(within: bool) -> str:
    return "✓" if within else "✗"


_TALL = 44
"""Least height of a terminal for the verdict in block letters, in rows."""
_LARGE = 32
"""Least height of a terminal for the stick drawing of five lines, in rows."""


class PilotScreen(Face):
    """The pilot's screen: word, verdict, progress and next input. Content changes place only for a reason."""

    HELP = """\
# Pilot

The large word is what to do now:

- **CONTINUE**: fly the next manoeuvre.
- **REPEAT**: the last manoeuvre is rejected; the line below gives the reason and the remedy.
- **RECOVER**: the free response of the manoeuvre in the air is recorded.
- **ENOUGH**: with the input in the air each derivative is within its tolerance; let go.
- **TEST COMPLETE**: the criterion fell below its limit. A later rejected manoeuvre is **NOT USED**.
- **WAIT**, **NO LINK**, **BEHIND**: no data are judged, or this computer is late. After a first verdict the
  last word stays, and its age stands below.
- **NO DATA**: the vehicle does not send what is needed; the line below says what to change.

✓ accepted, ✗ rejected, ∅ excluded by hand.

*next*: the stick over time, pull above, push below, with the seconds of each step; per cent of the stick's
travel, and degrees of elevator. *before it*: bank, air speed and angle of attack now, against their limits.
*how far*: manoeuvres flown, of those expected in all. **r** shows roll and yaw instead of the elevator: the
drawing has right above and left below. **k** turns bell and voice off and on.
"""

    def compose(self) -> ComposeResult:
        """Yield the parts from top to bottom, in the order of urgency."""
        yield StatusLine()
        yield Alarm()
        yield BigWord()
        yield Why()
        yield LastVerdict()
        yield NextInput()
        yield LimitsNow()
        yield Gauge()
        yield CrewNotes()
        yield ReplayBar()
        yield Ask()
        yield KeysLine()

    def on_resize(self, event: Resize) -> None:
        """Draw the stick large where there is room, and the verdict as well on a tall terminal."""
        self.set_class(event.size.height >= _LARGE, "-large")
        self.set_class(event.size.height >= _TALL, "-tall")
