"""Texts with which a script in the autopilot announces its test inputs, and the stretches between them.

``ADVISOR BEGIN 3 3-2-1-1`` and ``ADVISOR END 3 done`` (``done: enough`` before the full length, or
``aborted: why``) enclose one input. At its load
the script sends ``ADVISOR SCRIPT name hash``: the name of the aircraft file, and a hash of the calibration.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Literal, get_args

from advisor.aircraft.aircraft import ScriptIdentity
from advisor.flight.maneuvers.maneuver import InputKind, Notice
from advisor.words.problems import printable
from advisor.words.quantities import clock

TEXTS = (b"ADVISOR BEGIN", b"ADVISOR END", b"ADVISOR SCRIPT")
"""Beginnings of the announcements."""
SCRIPT_NOTICE = "script_mark"
"""Code of a notice about an announcement that marks nothing, or about a script of another aircraft."""
_BEGIN = re.compile(r"BEGIN (\d{1,6})(?: +(.*))?")
_END = re.compile(r"END (\d{1,6}) +(?:(done)(?: *:.*)?|aborted(?: *: *(.*))?)")
_SCRIPT = re.compile(r"SCRIPT +(.*\S) +(\S+)")
BOUNCE_S = 0.5
"""Longest time from BEGIN to END that counts as a bouncing switch, s. The shortest step that a script flies
lasts .2 s, and its input with two steps and their response lasts longer than this time."""
SWITCH = "switch"
"""Reason of a script for the early end of an input by its switch."""
_REPEAT_S = 0.5
"""Longest time, s, between two equal texts that count as one text over two paths."""
_BY_HAND = "mark the stretch by hand if it was flown"

PITCH_KINDS: frozenset[str] = frozenset({"3-2-1-1", "reverse 3-2-1-1", "doublet", "pulse", "multisine"})
"""Names of the elevator's inputs that an announcement may state."""
SIDE_KINDS: frozenset[str] = frozenset(get_args(InputKind)) - PITCH_KINDS - {"other"} | {"multisine"}
"""Names of inputs of aileron and rudder that an announcement may state."""


@dataclass(frozen=True, slots=True)
class Announcement:
    """A text of a script, in its parts."""

    word: Literal["begin", "end", "script", "unread"]
    number: int = 0
    said: str = ""
    """Name of the input, reason for the early end, or the whole text that was not understood."""
    aborted: bool = False
    script: ScriptIdentity | None = None
    """Identity of the aircraft file that a script was written from."""


@dataclass(frozen=True, slots=True)
class Announced:
    """An input that a script has announced and ended."""

    number: int
    input: str
    """Name of the input in the script's words."""
    aborted: str | None = None
    """Reason for which the input was ended early. None for a complete input."""

    @property
    def named(self) -> str:
        """Number and name of the input, for sentences."""
        return f"input {self.number} ({self.input})" if self.input else f"input {self.number}"

    def kind(self, names: frozenset[str], seen: InputKind) -> InputKind:
        """Return the announced name if an axis has this name, else the name of the movement that was seen."""
        return self.input if self.input in names else seen  # type: ignore[return-value]

    def moves(self, control: str) -> bool:
        """Return whether the announced name is an input of this control, or names no control."""
        if self.input in PITCH_KINDS ^ SIDE_KINDS:
            return (self.input in PITCH_KINDS) == (control == "elevator")
        return True

    def no_test(self, length_s: float) -> tuple[str, str] | None:
        """Return reason and sentence for an announced stretch that is no test; None for a test.

        Parameters
        ----------
        length_s
            Time from BEGIN to END, s.
        """
        if length_s < BOUNCE_S and self.aborted in (None, SWITCH):
            said = f"{self.named} ended after {length_s:.2f} s (a test lasts at least {BOUNCE_S} s)"
            return "bounce", f"{said}: its switch bounced; not a test input"
        if self.aborted is not None:
            return "aborted", f"{self.named} was ended early by the script: {self.aborted}; not judged"
        return None


@dataclass(frozen=True, slots=True)
class AnnouncedStretch:
    """Time between the two texts of an input."""

    start_s: float
    end_s: float
    announced: Announced


def read_announcement(raw: bytes) -> Announcement | None:
    """Return the parts of a script's text; None for a text that marks nothing and names no aircraft."""
    if not raw.startswith(TEXTS):
        return None
    said = printable(raw.removeprefix(b"ADVISOR ").decode("utf-8", "replace")).strip()
    if begin := _BEGIN.fullmatch(said):
        return Announcement("begin", int(begin[1]), (begin[2] or "").strip())
    if end := _END.fullmatch(said):
        return Announcement("end", int(end[1]), (end[3] or "no reason stated").strip(), aborted=not end[2])
    if script := _SCRIPT.fullmatch(said):
        return Announcement("script", script=ScriptIdentity(script[1], script[2]))
    return Announcement("unread", said=said)


class Announcements:
    """Pairs the texts of a script, and reports texts without a partner.

    Parameters
    ----------
    aircraft
        Identity of the aircraft file. None: every script is taken.
    """

    def __init__(self, aircraft: ScriptIdentity | None) -> None:
        self._aircraft = aircraft
        self.start_boot()

    def start_boot(self) -> None:
        """Begin another power-on without an open input."""
        self._begun: tuple[float, Announcement] | None = None
        self.alone_s: list[float] = []
        """Times of BEGIN and END without a partner, s since boot."""
        self._last: tuple[float, Announcement | None] = (-inf, None)

    @property
    def since_s(self) -> float | None:
        """Begin of the open input, s since boot. None without an open input."""
        return self._begun[0] if self._begun else None

    @property
    def open(self) -> Announced | None:
        """Open input. None without one."""
        return Announced(self._begun[1].number, self._begun[1].said) if self._begun else None

    def take(self, said: Announcement, at_s: float) -> Sequence[AnnouncedStretch | Notice]:
        """Take the next text, and return a complete stretch, or notices about texts that mark nothing."""
        last_s, last = self._last
        self._last = at_s, said
        if said == last and at_s - last_s <= _REPEAT_S:
            return ()
        if said.word == "script":
            return self._other_aircraft(said)
        if said.word == "unread":
            marks = "ADVISOR BEGIN number input and ADVISOR END number done"
            return (Notice(SCRIPT_NOTICE, f"The text ADVISOR {said.said} is no mark; marks are {marks}."),)
        if said.word == "begin":
            lost = self._dropped(f"before BEGIN {said.number} at {clock(at_s)}")
            self._begun = at_s, said
            return lost
        if self._begun is None or self._begun[1].number != said.number:
            where = f"ADVISOR END {said.number} at {clock(at_s)}"
            self.alone_s.append(at_s)
            alone = Notice(SCRIPT_NOTICE, f"{where} has no BEGIN, so it marks nothing; {_BY_HAND}.")
            return (*self._dropped(f"before {where}"), alone)
        (start_s, begun), self._begun = self._begun, None
        announced = Announced(begun.number, begun.said, said.said if said.aborted else None)
        return (AnnouncedStretch(start_s, at_s, announced),)

    def expire(self, now_s: float, longest_s: float) -> Sequence[Notice]:
        """Drop an open input that is longer than any mark, and return a notice about the input."""
        if self._begun is None or now_s - self._begun[0] <= longest_s:
            return ()
        return self._dropped(f"within {longest_s:.0f} s")

    def finish(self) -> Sequence[Notice]:
        """Drop an open input at the end of the power-on, and return a notice about the input."""
        return self._dropped("before the end of the messages")

    def _dropped(self, until: str) -> tuple[Notice, ...]:
        if self._begun is None:
            return ()
        (start_s, begun), self._begun = self._begun, None
        self.alone_s.append(start_s)
        named = Announced(begun.number, begun.said).named
        text = f"ADVISOR BEGIN at {clock(start_s)}, {named}, has no END {until}, so it marks nothing; "
        return (Notice(SCRIPT_NOTICE, f"{text}{_BY_HAND}."),)

    def _other_aircraft(self, said: Announcement) -> tuple[Notice, ...]:
        own, its = self._aircraft, said.script
        if own is None or its is None or its == own:
            return ()
        differs = f"was written for other calibrations of {own.name} than those in the aircraft file"
        if its.name != own.name:
            differs = f"was written for the aircraft {its.name}, and the aircraft file is that of {own.name}"
        text = f"The script in the autopilot {differs}; write the script anew: advisor script ardupilot."
        return (Notice(SCRIPT_NOTICE, text),)
