"""What the application says of its own accord, for a few seconds, above the foot of a screen."""

from textual.timer import Timer
from textual.widgets import Static


class Notice(Static):
    """A line that is always mounted: Textual's toasts come up a repaint after what they tell of."""

    def __init__(self) -> None:
        super().__init__(markup=False)
        self._hiding: Timer | None = None

    def say(self, text: str, seconds: float) -> None:
        """Show a text; one still shown is replaced."""
        if self._hiding is not None:
            self._hiding.stop()
        self.update(text)
        self.display = True
        self._hiding = self.set_timer(seconds, self._hide)

    def _hide(self) -> None:
        self.display = False
