"""Actions of keys on one pane: copy, save, show the next output, lay a manoeuvre or a channel over."""

from abc import abstractmethod
from io import StringIO

from advisor.session.view import View
from advisor.tui.panes.fit import Fit
from advisor.tui.panes.flight import WholeFlightPane
from advisor.tui.panes.pane import Pane
from advisor.tui.screens.face import Face
from advisor.tui.taking import files_of, pane_name, save

_SAY_S = 8.0
"""Time for which a sentence with a file path is shown, s. A path takes longer to read than a short message.
"""


class PaneActions(Face):
    """A screen whose keys act on the pane in front."""

    _view: View | None

    @abstractmethod
    def pane_in_front(self) -> Pane:
        """Return the pane with the focus, else the pane that was chosen last."""

    def action_copy(self) -> None:
        """Copy the pane to the clipboard of the terminal."""
        if self._view is None:
            return
        if self.app.is_web:
            self.say("the page cannot write the browser's clipboard; key s offers the pane as files", _SAY_S)
            return
        pane = self.pane_in_front()
        text = pane.text()
        self.app.copy_to_clipboard(text)
        what = f"{pane_name(pane, self._view)} copied, {text.count(chr(10))} lines."
        self.say(f"{what} If your terminal cannot copy (it lacks OSC 52), press s.", _SAY_S)

    def action_save(self) -> None:
        """Write the pane into files in the folder of the log, or offer the files to a browser."""
        if self._view is None:
            return
        pane = self.pane_in_front()
        if not self.app.is_web:
            self.say(save(pane, self._view), _SAY_S)
            return
        files = files_of(pane, self._view)
        for name, text in files.items():
            self.app.deliver_text(StringIO(text), save_filename=name)
        self.say(f"your browser is offered {' and '.join(files)}", _SAY_S)

    def action_next_output(self) -> None:
        """Bring the next output of the fit to the top."""
        self.query_one(Fit).next_output()

    def action_lay_over(self) -> None:
        """Lay the next channel over the whole flight, or ask for a manoeuvre to lay over the selected one."""
        pane = self.pane_in_front()
        if isinstance(pane, WholeFlightPane):
            pane.lay_over_next()
            return
        self.ask(
            "Number of the manoeuvre to lay over (0: none):",
            lambda answer: self._lay_over(int(answer)),
            integer=True,
        )

    def _lay_over(self, number: int) -> None:
        view = self._view
        judged = view.judged if view is not None else None
        if view is None or judged is None:
            self.say("There is no manoeuvre yet over which another could be laid.")
            return
        numbers = {j.maneuver.number for j in view.state.maneuvers}
        if number and (number not in numbers or number == judged.maneuver.number):
            self.say(f"Choose another manoeuvre than {judged.maneuver.number}, from {_listed(numbers)}.")
            return
        self.query_one(Fit).lay_over(number or None)
        self.show(view)


def _listed(numbers: set[int]) -> str:
    return f"{min(numbers)} to {max(numbers)}"
