"""Turn the data of a flight into the page, as HTML or Markdown."""

from functools import partial
from importlib.resources import files
from typing import Literal

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from advisor.process.parts import FailedPart, attempt
from advisor.report.page.appendix import assumptions, fields, provenance, telemetry, vibration
from advisor.report.page.axes.lateral_section import lateral
from advisor.report.page.blocks import Block, Content, Paragraph, Part, Section
from advisor.report.page.drawing import LAYER
from advisor.report.page.estimates import criterion, estimates
from advisor.report.page.fits import fits
from advisor.report.page.flight_picture import flight_picture
from advisor.report.page.flying_qualities import flying
from advisor.report.page.gap import gap
from advisor.report.page.headline import headline
from advisor.report.page.maneuvers import maneuvers
from advisor.words.quantities import CHANNELS

PageFormat = Literal["html", "md"]
_PARTS: tuple[Part, ...] = (
    headline, flight_picture, gap, estimates, criterion, flying, maneuvers, fits, lateral, fields,
    vibration, telemetry, assumptions, provenance,
)  # fmt: skip

_OF_PITCH = frozenset({estimates, criterion, flying, maneuvers, fits})
"""Parts of the page that a flight without an elevator test input lacks."""


def sections(content: Content) -> list[Section]:
    """Return all sections in the order of the page."""
    state = content.state
    is_tested = bool(state.maneuvers) and state.tested_sideways is None
    made = (_made(part, content) for part in _PARTS if is_tested or part not in _OF_PITCH)
    return [section for section in made if section is not None]


def _made(part: Part, content: Content) -> Section | None:
    """Return a section, or a sentence about the error that prevented it."""
    name = part.__name__
    made = attempt(f"page, {name.replace('_', ' ')}", partial(part, content))
    if not isinstance(made, FailedPart):
        return made
    return Section(name, name.replace("_", " ").capitalize(), (Paragraph(str(made.problem), "note"),))


def page(content: Content, form: PageFormat) -> str:
    """Return the whole page as text."""
    environment = Environment(
        autoescape=form == "html", trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True,
        undefined=StrictUndefined, loader=FunctionLoader(_read),
    )  # fmt: skip
    environment.filters |= {"kind": _kind, "drawn": Markup, "cell": _cell}
    return environment.get_template(f"page.{form}.j2").render(
        title=f"{content.aircraft.name}: {', '.join(content.names)}",
        sections=sections(content),
        channels=CHANNELS,
        layer=LAYER,
        css=Markup(_read("page.css")) if form == "html" else "",
    )


def _read(name: str) -> str:
    return (files("advisor.report.page") / name).read_text(encoding="utf-8")


def _kind(block: Block) -> str:
    return type(block).__name__


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
