"""Output of ``advisor foresee``: effects that a planned flight could show."""

import json
import math
from collections.abc import Sequence

import click
from rich import box
from rich.console import Console, ConsoleOptions, RenderResult
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.foresight.foresee import CONFUSED_AT, Foreseen
from advisor.gap.foresight.plan import TYPICAL_NOISE, foresee_plan
from advisor.gap.result import spelled
from advisor.gap.verdict.notes import unusual_signs
from advisor.report.facts.sizes import in_units
from advisor.report.table import PlainConsole
from advisor.words.plain import picked, plain
from advisor.words.quantities import symbol

_OF_LINEAR = {"M_alpha2": "M_alpha", "Z_alpha2": "Z_alpha", "M_delta2": "M_delta_e"}

_IN_WORDS = {"gain": "deg/s per deg", "M_throttle": "rad/s², full throttle", "M_thrust": "rad/s² of trim"}
_NO_ALPHA = (
    "Without an angle of attack, a flight is diagnosed only if VFR_HUD brings data to derive one: "
    "climb rate and air speed, at 10 Hz."
)
_ALIKE = 2
"""Number of similar effects that are printed. JSON contains all similar effects."""


def print_foresight(
    aircraft: Aircraft, plan: str, rate_hz: float, amplitude_deg: float, without: str, as_json: bool
) -> int:
    """Print each effect's smallest detectable size and the effects with a similar response; return exit code
    0.

    Raises
    ------
    ConfigurationError
        The aircraft file has no complete ``model``, or the planned flight or its sample rate is impossible.
    """
    inputs = [name.strip() for name in plan.split(",") if name.strip()]
    absent = [name.strip() for name in without.split(",") if name.strip()]
    foreseen = foresee_plan(aircraft, inputs, rate_hz, amplitude_deg, absent)
    notes = unusual_signs(aircraft.model)
    if "alpha" in absent:
        notes = (*notes, _NO_ALPHA)
    if as_json:
        click.echo(json.dumps(_document(foreseen, notes), allow_nan=False, indent=1))
        return 0
    kept = f", without {', '.join(absent)}" if absent else ""
    title = f"{len(inputs)} manoeuvres at {rate_hz:g} Hz, {amplitude_deg:g} deg of elevator{kept}"
    PlainConsole().print(ForesightScreen(title, foreseen, notes))
    return 0


class ForesightScreen:
    """Screen of detectable sizes, ways to distinguish similar effects, and undetectable effects."""

    def __init__(self, title: str, foreseen: Sequence[Foreseen], notes: Sequence[str] = ()) -> None:
        self.title, self.found, self.notes = title, foreseen, notes

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the notes, the table and the two lists."""
        yield Text(self.title, style="bold")
        yield Text(f"assumed noise: {_noise()}; speeds ±2 %, steps alternately 60 % of it", style="dim")
        for note in self.notes:
            yield Text(note)
        yield ""
        yield _table([f for f in self.found if math.isfinite(f.smallest)])
        ways = _ways(self.found)
        if ways:
            yield ""
            yield Text("To distinguish these:", style="bold")
            yield _listed(ways)
        hidden = [(spelled(f.effect), f.add) for f in self.found if not math.isfinite(f.smallest)]
        if hidden:
            yield ""
            yield Text("This plan cannot show (→ data that would show it):", style="bold")
            yield _listed([(name, f"→ {add}") for name, add in hidden])


def size_of(f: Foreseen) -> str:
    """Return the smallest detectable size with a unit for people."""
    factor, unit = in_units(f.parameter)
    size = abs(factor * f.smallest)
    if f.share is not None:
        return f"{100.0 * f.share:.2g} % of {symbol(_OF_LINEAR[f.parameter])}"
    if f.is_limit:
        return f"any limit below {_whole(size)} {unit}"
    if f.parameter in _IN_WORDS:
        return f"{size:.2g} {_IN_WORDS[f.parameter]}"
    return f"{_whole(size)} {unit}"


def _table(shown: Sequence[Foreseen]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    table.add_column("effect", no_wrap=True)
    table.add_column("shows from", no_wrap=True)
    table.add_column("looks like")
    for f in shown:
        alike = ", ".join(f"{spelled(name)} {100 * c:.0f} %" for name, c in f.confused_with[:_ALIKE])
        table.add_row(spelled(f.effect), size_of(f), Text(alike))
    return table


def _ways(foreseen: Sequence[Foreseen]) -> list[tuple[str, str]]:
    """Return each pair of similar effects once, with the way to distinguish the two effects."""
    ways: dict[frozenset[str], tuple[str, str]] = {}
    for f in foreseen:
        twins = [name for name, cosine in f.confused_with if cosine > CONFUSED_AT]
        if f.add and math.isfinite(f.smallest):
            pair = frozenset({f.effect, *twins})
            ways.setdefault(pair, (", ".join([spelled(f.effect), *map(spelled, twins)]), f.add))
    return list(ways.values())


def _listed(rows: Sequence[tuple[str, str]]) -> Padding:
    table = Table.grid(padding=(0, 2))
    table.add_column(max_width=30)
    table.add_column()
    for left, right in rows:
        table.add_row(Text(left), Text(right))
    return Padding(table, (0, 0, 0, 2))


def _noise() -> str:
    degrees = {c: math.degrees(TYPICAL_NOISE[c]) for c in ("alpha", "theta", "q")}
    return (
        f"α {degrees['alpha']:.1f} deg, θ {degrees['theta']:.1f} deg, q {degrees['q']:.1f} deg/s, "
        f"a_z {TYPICAL_NOISE['a_z']:.1f} m/s²"
    )


def _whole(x: float) -> str:
    """Return a number with two digits, or with all digits before the decimal point."""
    return f"{x:.0f}" if x >= 100.0 else f"{x:.2g}"


def _document(foreseen: Sequence[Foreseen], notes: Sequence[str]) -> dict[str, object]:
    return {
        "schema": "advisor.foresee/1",
        "effects": [
            {
                **picked(f, "effect parameter smallest add"),
                "share_of_linear": plain(f.share),
                "confused_with": [{"effect": name, "cosine": plain(c)} for name, c in f.confused_with],
            }
            for f in foreseen
        ],
        "notes": list(notes),
    }
