"""The plot widget: a chart painted on a braille canvas with axes, and a mouse that points into it."""

from rich.style import Style
from textual.events import MouseDown, MouseMove, MouseScrollDown, MouseScrollUp, MouseUp
from textual.message import Message
from textual.strip import Strip
from textual.widget import Widget

from advisor.tui.plot.chart import INKS, Chart, Ink
from advisor.tui.plot.painting import Painting, paint

_BOLD: frozenset[Ink] = frozenset({"fitted", "limit"})


class Plot(Widget):
    """Widget that paints a `Chart`. The plot is painted again only after the chart, the size or the theme has
    changed.
    """

    class Pointed(Message):
        """The mouse button was pressed, or the mouse was dragged, at a value of x."""

        def __init__(self, x: float) -> None:
            super().__init__()
            self.x = x

    class Wheeled(Message):
        """The wheel was turned over a value of x."""

        def __init__(self, x: float, up: bool, sideways: bool) -> None:
            super().__init__()
            self.x = x
            self.up = up
            """Whether the wheel was turned away from the user."""
            self.sideways = sideways
            """Whether the shift key was held."""

    def __init__(self, chart: Chart, *, id: str | None = None, classes: str | None = None) -> None:
        super().__init__(id=id, classes=classes)
        self._chart = chart
        self._painting: Painting | None = None

    @property
    def chart(self) -> Chart:
        return self._chart

    @chart.setter
    def chart(self, chart: Chart) -> None:
        if chart is not self._chart:
            self._chart = chart
            self._painting = None
            self.refresh()

    def on_resize(self) -> None:
        """Paint the chart again, because another size needs other ticks."""
        self._painting = None

    def notify_style_update(self) -> None:
        """Paint the chart again, because another theme needs other colours."""
        super().notify_style_update()
        self._painting = None

    def on_mouse_down(self, event: MouseDown) -> None:
        """Report the position of the mouse, and follow the mouse until its button is released."""
        if self._chart.x_range is not None:
            self.capture_mouse()
            self._point(event.x)

    def on_mouse_move(self, event: MouseMove) -> None:
        """Report the position again while the mouse button is down."""
        if self.app.mouse_captured is self:
            self._point(event.x)

    def on_mouse_up(self, event: MouseUp) -> None:
        self.release_mouse()

    def on_mouse_scroll_up(self, event: MouseScrollUp) -> None:
        """Report a turn of the mouse wheel."""
        self._wheel(event, up=True)

    def on_mouse_scroll_down(self, event: MouseScrollDown) -> None:
        """Report a turn of the mouse wheel."""
        self._wheel(event, up=False)

    def _point(self, column: int) -> None:
        x = self._painted().x_at(column, self.size.width)
        if x is not None:
            self.post_message(self.Pointed(x))

    def _wheel(self, event: MouseScrollUp | MouseScrollDown, *, up: bool) -> None:
        x = self._painted().x_at(event.x, self.size.width)
        if x is not None and self._chart.x_range is not None:
            event.stop()
            self.post_message(self.Wheeled(x, up, event.shift))

    def render_line(self, y: int) -> Strip:
        strips = self._painted().strips
        return strips[y] if y < len(strips) else Strip.blank(self.size.width, self.rich_style)

    def _painted(self) -> Painting:
        if self._painting is None:
            base = self.rich_style
            self._painting = paint(self._chart, self.size.width, self.size.height, base, self._inks(base))
        return self._painting

    def _inks(self, base: Style) -> list[Style]:
        """Return the colours of the theme. Textual's component classes would be computed at every change of
        focus.
        """
        colours = self.app.theme_variables
        return [base + Style(color=colours[f"ink-{ink}"], bold=ink in _BOLD) for ink in INKS]
