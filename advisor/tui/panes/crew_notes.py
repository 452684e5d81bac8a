"""Further notes for a pilot: the next input, the source of alpha, changes."""

from advisor.report.result_rows import parameter_row
from advisor.session.view import View
from advisor.tui.panes.hanging import HangingLines
from advisor.tui.panes.part import Part
from advisor.tui.words import headline


def alpha_in_words(view: View) -> str:
    """Return source and provenance of the angle of attack in one line."""
    alpha = view.state.channels.get("alpha")
    if alpha is None:
        return "no angle of attack heard yet"
    return f"{alpha.provenance}, from {alpha.source}, {alpha.rate_hz:.0f} Hz"


def flying_in_words(view: View) -> str:
    """Return a line on the manoeuvre in the air and its estimate."""
    flying, settling, marked_s = view.state.flying, view.state.settling, view.state.marking_since_s
    if marked_s is not None:
        return f"marked by hand for {view.state.now_s - marked_s:.0f} s"
    if flying is None:
        return "between manoeuvres"
    if settling is None or not view.state.readable:
        return view.state.progress
    row = parameter_row("M_alpha", settling, {})
    return f"{view.state.progress}; {row.quantity.symbol} {row.cell} {row.quantity.unit}"


def _link_in_words(view: View) -> str:
    """Return a line on the fault of the link; a sound link needs no moving numbers."""
    return "good" if view.health.condition == "good" else view.health.sentence


class CrewNotes(Part, HangingLines):
    """Next input, the manoeuvre in the air, alpha's provenance, warnings."""

    def show(self, view: View) -> None:
        """Write one line each; warnings last, each with its sign."""
        verdict = view.state.flight_test
        next_input = verdict.next.advice if verdict.next else "no advice yet"
        self.write_rows(
            (
                ("next        ", next_input.removeprefix("next: ")),
                ("in the air  ", flying_in_words(view)),
                ("α           ", alpha_in_words(view)),
                ("link        ", _link_in_words(view)),
                *(
                    ("! ", found.sentence)
                    for found in view.state.instruments
                    if found.contradicts and found.used
                ),
                *(("! ", headline(warning)) for warning in verdict.warnings),
            )
        )
