"""Diagnosis as text on a terminal: answer, place, causes and next steps. Details are printed on request."""

import shlex
from collections.abc import Iterator, Sequence
from textwrap import fill, indent

import numpy as np
from rich import box
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.constrain import Constrain
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.result import Diagnosis, InSimulator, Qualification, spelled
from advisor.gap.verdict.notes import UNEXPLAINED
from advisor.gap.verdict.text import limits_of
from advisor.process.installed import SIMULATOR
from advisor.report.facts.answers import sure_of, title_of
from advisor.report.facts.estimates import structure_lines
from advisor.report.facts.gap import changes, grown_said, law_said, shrink_said, size_of_gap, where_said
from advisor.report.facts.sizes import WORSE, named, short, with_error
from advisor.report.gap_causes import PRESENT, ranking, unseen, why_of
from advisor.report.gap_document import GapStep
from advisor.report.gap_fidelity import errors, peaks, whereabouts, worst_maneuver, yardsticks
from advisor.words.quantities import CHANNELS, Quantity

_QUANTITIES = CHANNELS | {"a_z": Quantity("a_z", "g", 1.0 / GRAVITY_M_S2)}
_LEGEND = (
    "Largest error in any manoeuvre. Limits: 14 CFR Part 60 App. A, 2.c.10, short period: pitch or pitch "
    "rate, and normal acceleration."
)


def simulated(inside: InSimulator, with_table: bool) -> Iterator[RenderableType]:
    """Yield the simulator's gap before and after the effects are added. On request yield the table of
    qualification too.
    """
    yield Text(f"in your simulator, {inside.simulator}", style="bold")
    yield Text("\n".join(_shrunk(inside)))
    if with_table:
        yield _table(inside)
        yield Text(_LEGEND, style="dim")


def _shrunk(inside: InSimulator) -> Iterator[str]:
    numbers = ", ".join(map(str, inside.maneuvers))
    if inside.after is None or inside.percent is None:
        yield f"gap {short(inside.before)} times the noise floor's power; nothing was flown with the effects"
        return
    if inside.after_air_and_instruments is None:
        yield f"gap {short(inside.before)} times the noise floor's power; nothing was changed, so 0 % less"
    else:
        yield (
            f"gap {short(inside.before)} → {short(inside.after)} with the corrections, {inside.percent:.1f} "
            f"% less, in manoeuvres that no search has used ({numbers})"
        )
        yield (
            f"gap {short(inside.after_air_and_instruments)} if this flight's air is taken into account, "
            f"which does not count as a reduction"
        )
    if inside.on_paper:
        names = ", ".join(spelled(name) for name in inside.on_paper)
        yield f"not flown, because this simulator cannot take them: {names}"


def _table(inside: InSimulator) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    for heading in ("", "limit", "before", "after", "", "Theil"):
        table.add_column(heading, justify="right" if heading else "left", no_wrap=True)
    for q in inside.qualification:
        quantity = _QUANTITIES[q.channel]
        factor = quantity.factor
        after = "" if q.after is None else f"{factor * q.after:.2f}"
        theil = f"{q.theil[0]:.3f}" + ("" if q.theil[1] is None else f" → {q.theil[1]:.3f}")
        limit = "" if q.limit is None else f"±{factor * q.limit:.2g}"
        table.add_row(
            f"{quantity.symbol}, {quantity.unit}",
            limit,
            f"{factor * q.before:.2f}",
            after,
            _in_words(q),
            theil,
        )
    return table


def _in_words(q: Qualification) -> str:
    if q.passes_before is None:
        return ""
    words = [
        "pass" if passed else "FAIL" for passed in (q.passes_before, q.passes_after) if passed is not None
    ]
    return " → ".join(words)


WIDEST = 120
"""Largest number of columns at which lines are easy to read."""
_PICTURES = {
    "pitch": (
        (
            ("input", "command → surface"),
            ("moment_equation", "pitching moment"),
            ("pitch_rate_sensor", "pitch rate"),
        ),
        (("air", "air"), ("force_equation", "lift"), ("alpha_sensor", "angle of attack")),
        (("timing", "time stamps"), ("accelerometer", "accelerometer"), ("attitude_sensor", "attitude")),
    ),
    "lateral": (
        (("aileron", "aileron"), ("rolling_moment", "rolling moment"), ("roll_rate_sensor", "roll rate")),
        (("rudder", "rudder"), ("yawing_moment", "yawing moment"), ("yaw_rate_sensor", "yaw rate")),
        (("air", "air"), ("side_force", "side force"), ("sideslip_sensor", "sideslip")),
        (("timing", "time stamps"), ("accelerometer", "accelerometer"), ("attitude_sensor", "attitude")),
    ),
}
"""Blocks of the simulator in the picture of each axis, row by row, with their labels."""
_SCORES = "per cent: how well a block would explain the gap on its own, the best 100 %"
_AS_GOOD = "100 % elsewhere: the data alone can hardly distinguish the two blocks"
_ROUNDS_TO_ALL = 0.995
_BAR = 40
_SPEED = "airspeed_variation"
"""Effect that needs no next step if the simulator already uses the measured air speed."""


class GapScreen:
    """Screen of a diagnosis for an engineer, readable without colour and at 80 columns."""

    def __init__(
        self,
        diagnosis: Diagnosis,
        improved: str | None = None,
        why: bool = False,
        steps: Sequence[GapStep] = (),
        everything: bool = False,
    ) -> None:
        self.diagnosis, self.improved, self.why, self.steps = diagnosis, improved, why, steps
        self.everything = everything

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the parts from the verdict to the next steps."""
        width = min(options.max_width, WIDEST)
        yield Constrain(Group(*self._parts(width)), width)

    def _parts(self, width: int) -> Iterator[RenderableType]:
        d = self.diagnosis
        tested = d.verdict != "untested"
        yield Panel(Group(*_answer(d)), title=title_of(d), title_align="left")
        if d.gap.by_channel:
            yield _numbers(d)
        if d.instruments:
            yield Text("Nuisance parameters of the fit, which are not part of the answer:")
            yield from (Text(f"  {named(name)} {with_error(name, x)}") for name, x in d.instruments.items())
        if d.structured is not None:
            yield from map(Text, structure_lines(d.structured))
        if tested and d.verdict != "none":
            where = (
                f"where: {where_said(d.where, d.shrink)}" if d.verdict in ("effect", "unknown") else "where"
            )
            yield Panel(Group(*_picture(d)), title=where, title_align="left")
        if self.everything and tested:
            yield from self._course()
        if tested and d.causes and (d.verdict != "none" or self.everything):
            yield ""
            yield from ranking(d.causes, d.gap.before, _improved(d))
        if self.why and tested:
            yield from why_of(d)
        if d.in_simulator is not None:
            yield ""
            yield from simulated(d.in_simulator, self.everything)
        if self.everything:
            yield from self._errors(width) if tested else ()
            yield from self._limits(width)
        if self.improved is not None:
            yield ""
            yield Text(
                f"The improved simulator is {self.improved}; python -m {SIMULATOR} flies it with --aircraft."
            )
        if self.steps:
            yield ""
            yield Text("Next:", style="bold")
            yield from _numbered(self.steps, width)
        if not self.everything:
            yield Text(self._more(), style="dim")

    def _course(self) -> Iterator[RenderableType]:
        """Yield the gap by phase, band and manoeuvre, and after each added effect."""
        d = self.diagnosis
        yield Panel(whereabouts(d.gap), title="where in the flight", title_align="left")
        added = [step for step in d.waterfall if step != (_SPEED, d.gap.before)]
        if added:
            title = "gap as effects are added, one after another"
            yield Panel(_waterfall(d.gap.before, added), title=title, title_align="left")

    def _errors(self, width: int) -> Iterator[RenderableType]:
        """Yield the error in the worst manoeuvre, and the fidelity measures by channel."""
        d = self.diagnosis
        title = f"error in manoeuvre {worst_maneuver(d)}, the one with the largest gap (absolute value)"
        yield ""
        yield Panel(errors(d, width), title=title, title_align="left")
        yield ""
        yield from yardsticks(d)

    def _limits(self, width: int) -> Iterator[RenderableType]:
        """Yield the notes, and the effects that the flight cannot show."""
        yield ""
        yield from (_hanging("·", note, width) for note in _notes(self.diagnosis))
        if self.diagnosis.cannot_see:
            yield ""
            yield Text("This flight could not show (→ data that would show it):", style="bold")
            yield unseen(self.diagnosis.cannot_see)

    def _more(self) -> str:
        notes, hidden = _notes(self.diagnosis), self.diagnosis.cannot_see
        return (
            f"--all adds the gap in time and by manoeuvre, the fidelity by channel, {len(notes)} notes and "
            f"{len(hidden)} effects that this flight could not show."
        )


def _answer(d: Diagnosis) -> Iterator[Text]:
    """Yield the sentence, the differing derivatives, the errors in an engineer's units, and the limits."""
    yield Text(d.sentence)
    if sure := sure_of(d):
        yield Text(sure)
    if d.verdict == "unknown":
        yield from (Text(note) for note in d.notes if note.startswith(UNEXPLAINED))
    if d.missing_law is not None:
        yield Text(law_said(d.missing_law))
    if d.verdict == "parameters":
        yield from (Text(f"  {line}") for line in changes(d.derivatives))
    if d.verdict not in ("none", "untested") and d.gap.after != d.gap.before and d.traces:
        yield Text(peaks(d.traces))
    yield from (Text(f"! {limit}") for limit in limits_of(d))


def _notes(d: Diagnosis) -> list[str]:
    floor = d.gap.floor_note and f"Noise floor {d.gap.floor_note}."
    return [note for note in (d.kinematics and d.kinematics.sentence, floor, *d.notes) if note]


def _improved(d: Diagnosis) -> str:
    return "simulator" if d.derivatives else "model"


def _numbered(steps: Sequence[GapStep], width: int) -> Iterator[Text]:
    """Yield each step with its command line. No blank follows a backslash, because a shell would read the
    blank as a word.
    """
    for number, step in enumerate(steps, start=1):
        mark = f"{number}."
        yield _hanging(mark, step.text, width)
        if step.command:
            lines = command_lines(step.command, width - len(f"{mark} "))
            command = indent("\n".join(lines), " " * len(f"{mark} "))
            yield Text(command, style="bold", no_wrap=True, overflow="ignore")


def command_lines(command: str, width: int) -> list[str]:
    """Return a command in lines for a shell. Lines break between words at the width of the terminal."""
    lines, words = [""], list(map(shlex.quote, shlex.split(command)))
    for word, value in zip(words, [*words[1:], ""], strict=True):
        # An option stays with its value.
        ahead = f" {value}" if word.startswith("--") else ""
        if lines[-1] and len(f"{lines[-1]} {word}{ahead} \\") > width:
            lines[-1] += " \\"
            lines.append("")
        lines[-1] += f" {word}" if lines[-1] else word
    return lines


def _hanging(mark: str, text: str, width: int) -> Text:
    behind = " " * len(f"{mark} ")
    return Text(fill(f"{mark} {text}", width, subsequent_indent=behind, break_on_hyphens=False))


def _numbers(d: Diagnosis) -> Text:
    lines = [size_of_gap(d.verdict, d.gap)]
    if d.shrink is not None and d.verdict not in ("none", "untested"):
        lines.append(shrink_said(d.shrink, d.gap))
        if d.shrink.beyond_air_percent is not None:
            lines.append(
                f"without the corrections for this flight's air: {d.shrink.beyond_air_percent:.0f} % less"
            )
    if d.verdict != "untested" and (grown := grown_said(d.verdict, d.gap)):
        lines.append(f"{WORSE} {grown}")
    return Text("\n".join(lines))


def _picture(d: Diagnosis) -> Iterator[RenderableType]:
    """Yield the simulator as blocks. The block with the gap stands between arrows; other blocks
    have a score.
    """
    table = Table.grid(expand=True, padding=(0, 1))
    guilty = d.where.block if d.verdict in ("effect", "unknown") else ""
    places = {block for row in _PICTURES[d.axis] for block, _ in row}
    taking_part = {at for c in d.causes if c.present for at in (c.block, c.of)} & places - {guilty}
    scores = {
        block: score
        for block, score in d.where.ranking
        if round(100.0 * score) > 0 and block != guilty and block not in taking_part
    }
    for row in _PICTURES[d.axis]:
        cells = []
        for block, label in row:
            if block == guilty:
                cells.append(Text(f"▶ {label.upper()} ◀", style="bold reverse"))
            elif block in taking_part:
                cells.append(Text(f"[{label}] {PRESENT}", style="bold"))
            elif block in scores:
                cells.append(Text(f"[{label}] {100 * scores[block]:.0f} %"))
            else:
                cells.append(Text(f"[{label}]", style="dim"))
        table.add_row(*cells)
    yield table
    if taking_part:
        yield Text(f"{PRESENT} also in the improved {_improved(d)}", style="dim")
    if scores:
        yield Text(_SCORES, style="dim")
    if guilty and any(score >= _ROUNDS_TO_ALL for score in scores.values()):
        yield Text(_AS_GOOD, style="dim")


def _waterfall(before: float, added: Sequence[tuple[str, float]]) -> Text:
    largest = max(before, *(after for _, after in added), 1e-12)
    lines = []
    for name, value in (("as it is", before), *added):
        bar = "█" * round(_BAR * float(np.log1p(max(value, 0.0)) / np.log1p(largest)))
        step = name if name == "as it is" else f"+ {spelled(name)}"
        lines.append(f"{step:27s}{short(value):>8s} {bar}")
    return Text("\n".join(lines), no_wrap=True, overflow="crop")
