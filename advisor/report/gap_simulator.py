"""Text on the gap in the user's own simulator, and on the simulator's qualification as a training device."""

from collections.abc import Iterator

from rich import box
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.result import InSimulator, Qualification, spelled
from advisor.report.facts.sizes import short
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
