"""Templates of the pages, filled with text that is escaped."""

from functools import cache
from pathlib import Path

import jinja2
from aiohttp import web

STATIC = Path(__file__).parent / "static"
_TEMPLATES = Path(__file__).parent / "templates"


@cache
def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined
    )


def page(name: str, status: int = 200, **values: object) -> web.Response:
    """Fill a template.

    Parameters
    ----------
    name
        ``screens``, ``login`` or ``message``.
    status
        HTTP status.
    **values
        Values for the template.
    """
    text = _environment().get_template(f"{name}.html.j2").render(**values)
    return web.Response(text=text, content_type="text/html", status=status)
