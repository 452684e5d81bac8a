"""The next input of the pilot: a drawing of the stick with seconds, per cent and degrees."""

from math import degrees

from textual.events import Resize

from advisor.decision.verdict import NextInput as Advised
from advisor.session.view import View
from advisor.tui.panes.lines import Lines
from advisor.tui.panes.part import Part
from advisor.tui.stick_drawing import stick_drawing, stick_line

_LABEL = "next        "
SIDES = {"elevator": ("pull", "push"), "aileron": ("right", "left"), "rudder": ("right", "left")}
"""Control to the names of both directions: above trim in the drawing, and below."""


class NextInput(Part, Lines):
    """The advice in words over its drawing. A low terminal has one line of drawing next to the words."""

    EITHER_AXIS = True

    def __init__(self) -> None:
        super().__init__()
        self._advised: Advised | None = None

    def show(self, view: View) -> None:
        """Draw the input that is advised now."""
        self._advised = view.state.flight_test.next
        self._write()

    def on_resize(self, event: Resize) -> None:
        """Draw as large as there is room."""
        self._write()

    def _write(self) -> None:
        if self._advised is not None and self.size.width:
            self.write(drawn(self._advised, self.size.width, large=self.screen.has_class("-large")))


def drawn(advised: Advised, width: int, *, large: bool) -> str:
    """Return the advice, and the drawing of the input that the advice names."""
    words = f"{_LABEL}{advised.advice.removeprefix('next: ')}"
    flown = advised.input
    if flown is None:
        return words
    words = f"{words}, ±{degrees(flown.amplitude_rad):.1f} deg of {flown.control}"
    sides = SIDES[flown.control]
    if not large:
        first = sides[0] if flown.nose_up_first else sides[1]
        return f"{words}\n{'':<{len(_LABEL)}}{stick_line(flown.steps)}  {first} first"
    indent = " " * len(_LABEL)
    picture = stick_drawing(flown.steps, width - len(_LABEL), sides)
    return "\n".join([words, *(f"{indent}{line}" for line in picture.split("\n") if picture)])
