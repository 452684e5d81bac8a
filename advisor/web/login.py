"""The page that asks for the password, and the cookie of a browser."""

import asyncio

from aiohttp import web

from advisor.web.access import Access
from advisor.web.rendering import page

AFTER_WRONG_S = 1.0
"""Pause after a wrong password, s. Guesses are checked one after another, one a second."""
MOST_WAITING = 20
"""Most guesses that may wait for their turn. Further ones are refused at once."""
_BUSY = "Too many passwords are being tried at this moment. Try again in a minute."


class Login:
    """Asks for the password once per browser.

    Parameters
    ----------
    access
        Holder of the password.
    """

    def __init__(self, access: Access) -> None:
        self._access = access
        self._turn = asyncio.Lock()
        self._waiting = 0

    async def show(self, request: web.Request) -> web.Response:
        """Ask for the password."""
        return page("login", wrong=False)

    async def check(self, request: web.Request) -> web.Response:
        """Let a browser with the right password in. A wrong password costs a second."""
        if not self._access.is_own_page(request.headers.get("Origin"), request.scheme, request.host):
            raise web.HTTPForbidden(text="This form belongs to another page.")
        if self._waiting >= MOST_WAITING:
            raise web.HTTPTooManyRequests(text=_BUSY)
        given = str((await request.post()).get("password", ""))
        self._waiting += 1
        try:
            async with self._turn:
                if not self._access.is_password(given):
                    await asyncio.sleep(AFTER_WRONG_S)
                    return page("login", status=403, wrong=True)
        finally:
            self._waiting -= 1
        response = web.Response(status=303, headers={"Location": "/"})
        response.set_cookie(
            self._access.cookie,
            self._access.token,
            httponly=True,
            samesite="Lax",
            secure=request.secure or (self._access.origin or "").startswith("https:"),
        )
        return response
