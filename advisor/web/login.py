"""The page that asks for the password, the cookie of a browser, and templates filled with escaped text."""

import asyncio
from collections import defaultdict
from functools import cache
from pathlib import Path

import jinja2
from aiohttp import web

from advisor.web.access import Access

AFTER_WRONG_S = 1.0
"""Pause after a wrong password, s. Wrong guesses from one address wait one after another."""
MOST_WAITING = 20
"""Largest number of wrong guesses from one address that may wait. Further guesses from this address are
refused without a check, so that an address has one guess a second."""
_BUSY = "Too many passwords are being tried at this moment. Try again in a minute."


class _Turn:
    """Pauses of the wrong guesses from one address, one after another."""

    def __init__(self) -> None:
        self._lock = asyncio.Lock()
        self.waiting = 0

    async def pause(self) -> None:
        """Wait for the earlier guesses, and then for the pause."""
        self.waiting += 1
        try:
            async with self._lock:
                await asyncio.sleep(AFTER_WRONG_S)
        finally:
            self.waiting -= 1


class Login:
    """Asks for the password once in each browser."""

    def __init__(self, access: Access) -> None:
        self._access = access
        self._turns: dict[str, _Turn] = defaultdict(_Turn)

    async def show(self, request: web.Request) -> web.Response:
        """Show the page that asks for the password."""
        return page("login", wrong=False)

    async def check(self, request: web.Request) -> web.Response:
        """Admit a browser with the right password immediately. After a wrong password the answer waits one
        second."""
        if not self._access.is_own_page(request.headers.get("Origin"), request.scheme, request.host):
            raise web.HTTPForbidden(text="This form belongs to another page.")
        given = str((await request.post()).get("password", ""))
        address = request.remote or ""
        turn = self._turns[address]
        if turn.waiting >= MOST_WAITING:
            raise web.HTTPTooManyRequests(text=_BUSY)
        if not self._access.is_password(given):
            await turn.pause()
            if not turn.waiting:
                self._turns.pop(address, None)
            return page("login", status=403, wrong=True)
        response = web.Response(status=303, headers={"Location": "/"})
        response.set_cookie(
            self._access.cookie,
            self._access.token,
            httponly=True,
            samesite="Lax",
            secure=request.secure or (self._access.origin or "").startswith("https:"),
        )
        return response


STATIC = Path(__file__).parent / "static"
_TEMPLATES = Path(__file__).parent / "templates"


@cache
def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined
    )


def page(name: str, status: int = 200, **values: object) -> web.Response:
    """Return the page from a template.

    Parameters
    ----------
    name
        ``screens``, ``login`` or ``message``.
    """
    text = _environment().get_template(f"{name}.html.j2").render(**values)
    return web.Response(text=text, content_type="text/html", status=status)
