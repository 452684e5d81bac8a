"""Access to the pages: the password and its page, and the pages that may send requests."""

import asyncio
import hmac
import os
import secrets
import sys
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from ipaddress import ip_address
from pathlib import Path
from urllib.parse import urlsplit

import click
import jinja2
from aiohttp import web

from advisor.words.problems import ConfigurationError

_HERE = frozenset({"localhost", "127.0.0.1", "::1"})


def on_this_computer(host: str) -> bool:
    """Return whether only programs of this computer can reach an address."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def checked_origin(address: str) -> str:
    """Return the address of a proxy in the form that browsers send as ``Origin``.

    Parameters
    ----------
    address
        As a user writes it: ``https://flight.example`` or ``https://flight.example:8443/``.

    Raises
    ------
    ConfigurationError
        The address is no ``http`` or ``https`` address, or names a place below the root.
    """
    parts = urlsplit(address)
    if parts.scheme not in ("http", "https") or not parts.netloc or parts.path.strip("/") or parts.query:
        raise ConfigurationError(
            f"--origin {address}: give the address that browsers see, without a path, "
            "e.g. https://flight.example."
        )
    return f"{parts.scheme}://{parts.netloc}".lower()


@dataclass(frozen=True, slots=True)
class Access:
    """Decides whether a request to the server is allowed. One password gives access to all viewers."""

    password: str | None = field(default=None, repr=False)
    """Password of the pages. None: every program that reaches the server has access, so that only this
    computer may reach the server."""
    origin: str | None = None
    """Address of the server in the browser, if a proxy stands in front of the server. None: no proxy."""
    token: str = field(default_factory=lambda: secrets.token_urlsafe(32), repr=False)
    """Cookie of a browser that has sent the password. Each start of the server makes a new cookie."""

    @property
    def cookie(self) -> str:
        """Name of the cookie, different for each server: browsers share cookies among the ports of a host."""
        return f"advisor-{sha256(self.token.encode()).hexdigest()[:8]}"

    def is_called_properly(self, host: str) -> bool:
        """Return whether a browser addresses the server by one of the server's names.

        Without a password only the names of this computer are allowed. Otherwise a foreign page could give
        its own name the address 127.0.0.1 (DNS rebinding) and read the screens.

        Parameters
        ----------
        host
            The request's ``Host``, with or without a port.
        """
        try:
            return self.password is not None or urlsplit(f"//{host}").hostname in _HERE
        except ValueError:  # no address at all
            return False

    def is_own_page(self, origin: str | None, scheme: str, host: str) -> bool:
        """Return whether a request comes from a page of this server.

        Parameters
        ----------
        origin
            The request's ``Origin``; None where a program that is no browser has sent none.
        scheme, host
            How the server was called: ``http``, and the request's ``Host``.
        """
        return origin is not None and origin.lower() in (f"{scheme}://{host}".lower(), self.origin)

    def lets_in(self, token: str | None) -> bool:
        """Return whether a request is allowed; ``token`` is its cookie, None without a cookie."""
        return self.password is None or _same(token or "", self.token)

    def is_password(self, given: str) -> bool:
        """Return whether a text is the password, in a time that does not depend on the text."""
        return self.password is not None and _same(given, self.password)


def _same(a: str, b: str) -> bool:
    """Compare two texts in constant time; the digests make both equally long."""
    digests = (sha256(text.encode("utf-8", "surrogatepass")).digest() for text in (a, b))
    return hmac.compare_digest(*digests)


VARIABLE = "ADVISOR_PASSWORD"
SHORTEST = 8
"""Least length of the password. At one guess a second, eight random letters or digits outlast campaigns."""


def read_password(file: Path | None, needed_for: str) -> str | None:
    """Return the password of the pages.

    Parameters
    ----------
    file
        File whose first line is the password; None: the environment variable, else a prompt.
    needed_for
        Option that makes a password necessary, as the user wrote it. Empty: the password may be missing.

    Raises
    ------
    ConfigurationError
        The file cannot be read, the password is too short, or a password is needed and no terminal can ask
        for one.
    """
    # Removed from the environment, because no process started here needs the password.
    given = os.environ.pop(VARIABLE, None)
    if file is not None:
        return _long_enough(_first_line(file), f"--password-file {file}")
    if given:
        return _long_enough(given, VARIABLE)
    if not needed_for:
        return None
    if not sys.stdin.isatty():
        raise ConfigurationError(
            f"{needed_for} opens the pages to other computers and needs a password: "
            f"give --password-file FILE, or set {VARIABLE}."
        )
    asked: str = click.prompt("Password of the pages", hide_input=True, confirmation_prompt=True, err=True)
    return _long_enough(asked, "This password")


def _first_line(file: Path) -> str:
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text"
        raise ConfigurationError(
            f"--password-file {file} cannot be read: {reason}; name another file."
        ) from error
    if os.name == "posix" and file.stat().st_mode & 0o077:
        click.echo(f"other users can read {file}: chmod 600 {file}", err=True)
    return text.splitlines()[0] if text else ""


def _long_enough(password: str, where: str) -> str:
    if len(password) < SHORTEST:
        raise ConfigurationError(
            f"{where} holds {len(password)} characters; a password of the pages has at least {SHORTEST}."
        )
    return password


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
