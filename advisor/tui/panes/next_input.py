"""The next input of the pilot: a drawing of the stick with seconds, per cent and degrees."""

from textual.events import Resize

from advisor.decision.verdict import NextInput as Advised
from advisor.session.view import View
from advisor.tui.panes.lines import Lines, Part
from advisor.tui.stick_drawing import drawn


class NextInput(Part, Lines):
    """The advised input in words above its drawing. On a low terminal the drawing is one line next to the
    words."""

    EITHER_AXIS = True

    def __init__(self) -> None:
        super().__init__()
        self._advised: Advised | None = None

    def show(self, view: View) -> None:
        """Draw the input that is advised now, of the axis that lacks most where both are tested."""
        self._advised = view.plan.next if view.plan is not None else view.state.flight_test.next
        self._write()

    def on_resize(self, event: Resize) -> None:
        """Draw as large as there is room."""
        self._write()

    def _write(self) -> None:
        if self._advised is not None and self.size.width:
            self.write(drawn(self._advised, self.size.width, large=self.screen.has_class("-large")))
