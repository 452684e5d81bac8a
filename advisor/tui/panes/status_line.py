"""The first line of every screen: aircraft, mode, and condition of the link."""

from advisor.session.behind import spoken
from advisor.session.view import View
from advisor.tui.panes.lines import Lines
from advisor.tui.panes.part import Part

CONDITIONS = {
    "good": "✓ link good",
    "poor": "! link poor",
    "waiting": "… waiting",
    "lost": "✗ LINK LOST",
    "stale": "✗ NOT ANSWERING",
    "ended": "■ end of log",
}


class StatusLine(Part, Lines):
    """Condition of the link by symbol and word, recording, aircraft, vehicle, mode and source."""

    EITHER_AXIS = True

    def show(self, view: View) -> None:
        """Write the line. Its colour follows the link's condition."""
        state = view.state
        vehicle = str(state.vehicle) if state.vehicle else "no vehicle yet"
        parts = [
            CONDITIONS[view.health.condition],
            f"✗ {spoken(view.health.behind_s)} BEHIND" if view.health.behind else "",
            view.health.recording,
            view.aircraft.name,
            vehicle,
            state.mode,
            view.title,
            "ROLL AND YAW" if view.elevator is not None else "",
        ]
        self.write("  ·  ".join(part for part in parts if part))
        for condition in CONDITIONS:
            self.set_class(condition == view.health.condition, f"-{condition}")
        self.set_class(bool(view.health.behind), "-behind")
