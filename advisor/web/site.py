"""The web server: the page with the screens, its WebSocket, and the login page."""

import asyncio
import json
import os
import socket
from asyncio.subprocess import PIPE, Process
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path
from threading import Thread
from typing import Self

import textual_serve
from aiohttp import WSMsgType, web
from textual_serve.app_service import AppService
from textual_serve.download_manager import DownloadManager
from textual_serve.server import Server

from advisor.mavlink.link.kept_link import Door
from advisor.process.children import python_module
from advisor.web.access import STATIC, Access, Login, page
from advisor.web.showing import ADDRESS, KEY
from advisor.words.problems import ConfigurationError


class PageProcess(AppService):
    """Runs the screens for one browser page, from `start` to `end`.

    Parameters
    ----------
    socket
        The page's own WebSocket, which is closed when the process ends.
    """

    def __init__(self, door: Door, socket: web.WebSocketResponse, downloads: DownloadManager) -> None:
        super().__init__(
            "",
            write_bytes=socket.send_bytes,
            write_str=socket.send_str,
            close=self._close,
            download_manager=downloads,
        )
        self._door, self._socket, self._ending = door, socket, asyncio.Lock()

    async def run(self) -> None:
        """Send the application's output to the page. A page whose process has ended is closed."""
        with suppress(ConnectionError):  # the browser is gone
            await super().run()
        await self._close()

    async def end(self) -> None:
        """End the process immediately, because it keeps no file open.

        The page and the server may call this at the same time. The first call ends the process, and every
        call returns when it has ended.
        """
        async with self._ending:
            process = self._process
            if process is None:
                return
            if self._task is not None and not self._task.done():
                with suppress(ProcessLookupError):
                    process.kill()
            await self.stop()
            await process.wait()

    async def _close(self) -> None:
        await self._socket.close()

    async def _open_app_process(self, width: int = 80, height: int = 24) -> Process:
        environment = self._build_environment(width, height)
        self._process = await asyncio.create_subprocess_exec(
            *python_module("advisor.web.viewer"),
            stdin=PIPE,
            stdout=PIPE,
            stderr=PIPE,
            env={**environment, ADDRESS: self._door.address, KEY: self._door.key.hex()},
            # An interrupt in the terminal is for the server, which ends the pages in order.
            start_new_session=os.name == "posix",
        )
        self._stdin = self._process.stdin
        return self._process


_Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]

LARGEST_MESSAGE = 65_536
"""Largest message of a browser, bytes: keys, or a pasted text."""
HEARTBEAT_S = 15.0
"""Time after which the page of a silent browser is closed, s."""
_GOODBYE_S = 2.0
"""Longest time for a browser's answer to the closing of its page, s."""
_COLUMNS, _ROWS = (20, 500), (5, 200)
"""Smallest and largest size of a page, in characters. A larger page would only use memory."""
_OPEN_TO_ALL = ("/login", "/static/", "/textual/")
_HEADERS = {
    # The browser itself then refuses to load anything from another host.
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "font-src 'self'; img-src 'self' data:; connect-src 'self'; form-action 'self'; base-uri 'none'; "
    "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Server": "advisor",
    "Referrer-Policy": "same-origin",
}


class Site:
    """The pages of one campaign.

    Parameters
    ----------
    most
        Largest number of pages at once.
    """

    def __init__(self, access: Access, door: Door, title: str, closed: str, most: int) -> None:
        self._access, self._door, self._most = access, door, most
        self._title, self._closed = title, closed
        self._textual = Server("", title=title)
        self._pages: set[PageProcess] = set()

    def application(self) -> web.Application:
        """Return the web application: its routes, and the checks before every route."""
        application = web.Application(middlewares=[self._guard])
        login = Login(self._access)
        application.add_routes(
            [
                web.get("/", self._screens),
                web.get("/ws", self._socket),
                web.get("/alive", self._alive),
                web.get("/download/{key}", self._textual.handle_download),
                web.get("/login", login.show),
                web.post("/login", login.check),
                web.static("/static", STATIC),
                web.static("/textual", Path(textual_serve.__file__).parent / "static"),
            ]
        )
        application.on_response_prepare.append(_add_headers)
        return application

    async def close(self) -> None:
        """Close every page and end the page's process."""
        await asyncio.gather(*(process.end() for process in self._pages))

    @web.middleware
    async def _guard(self, request: web.Request, handler: _Handler) -> web.StreamResponse:
        if not self._access.is_called_properly(request.host):
            raise web.HTTPForbidden(text="Open this server by the address that advisor serve has printed.")
        if request.path.startswith(_OPEN_TO_ALL) or self._access.lets_in(
            request.cookies.get(self._access.cookie)
        ):
            return await handler(request)
        if request.path == "/":
            raise web.HTTPSeeOther("/login")
        raise web.HTTPForbidden(text="Give the password first, at /login.")

    async def _screens(self, request: web.Request) -> web.Response:
        if self._is_full:
            return page("message", status=503, message=self._full)
        return page("screens", title=self._title, closed=self._closed)

    async def _alive(self, request: web.Request) -> web.Response:
        return web.Response(status=204)

    @property
    def _is_full(self) -> bool:
        return len(self._pages) >= self._most

    @property
    def _full(self) -> str:
        return (
            f"Every place is taken: {self._most} at once is the most. Close a page elsewhere, or start "
            "advisor serve with a larger --viewers."
        )

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        if not self._access.is_own_page(request.headers.get("Origin"), request.scheme, request.host):
            raise web.HTTPForbidden(text="This WebSocket is for the server's own page.")
        if self._is_full:
            raise web.HTTPServiceUnavailable(text=self._full)
        socket = web.WebSocketResponse(
            timeout=_GOODBYE_S, heartbeat=HEARTBEAT_S, max_msg_size=LARGEST_MESSAGE
        )
        process = PageProcess(self._door, socket, self._textual.download_manager)
        self._pages.add(process)
        try:
            await socket.prepare(request)
            await process.start(
                _within(request.query.get("width"), _COLUMNS), _within(request.query.get("height"), _ROWS)
            )
            with suppress(ConnectionError, ValueError, RecursionError):  # gone, or no message of the terminal
                await _pass_on(socket, process)
        finally:
            await process.end()
            self._pages.discard(process)
        return socket


async def _pass_on(socket: web.WebSocketResponse, process: PageProcess) -> None:
    """Send a browser's messages to the page's process until the page is closed."""
    async for message in socket:
        if message.type is not WSMsgType.TEXT:
            return
        match json.loads(message.data):
            case ["stdin", str(keys)]:
                await process.send_bytes(keys.encode("utf-8", "ignore"))
            case ["resize", {"width": width, "height": height}]:
                await process.set_terminal_size(_within(width, _COLUMNS), _within(height, _ROWS))
            case ["focus"]:
                await process.focus()
            case ["blur"]:
                await process.blur()
            case ["ping", str(stamp)]:
                await socket.send_json(["pong", stamp])


def _within(size: object, limits: tuple[int, int]) -> int:
    """Return the number of characters of a page, within the limits."""
    least, most = limits
    try:
        return min(max(int(str(size)), least), most)
    except ValueError:
        return least


async def _add_headers(request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(_HEADERS)
    if not request.path.startswith(("/static/", "/textual/")):
        response.headers["Cache-Control"] = "no-store"


def listening(host: str, port: int) -> socket.socket:
    """Reserve a port, before any other work begins.

    Raises
    ------
    ConfigurationError
        The port is in use, or the host is no address of this computer.
    """
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family)
    except OSError as error:
        raise ConfigurationError(
            f"The pages cannot be served at {host}, port {port}: {_reason(error)}. "
            "End the program that uses the port, or give another --port or --host."
        ) from error


def _reason(error: OSError) -> str:
    """Return the system's reason for a refusal, without the address that Python adds."""
    if isinstance(error, socket.gaierror) or error.errno is None:
        return str(error.strerror or error)
    return os.strerror(error.errno)


class WebServer:
    """Serves a site from the start of the context to its end."""

    def __init__(self, site: Site, at: socket.socket) -> None:
        self._site, self._at = site, at
        self._loop = asyncio.new_event_loop()
        self._stop = asyncio.Event()
        self._thread = Thread(target=self._run, name="web", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        if self.at_work:
            self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join()  # every page bounds its own end

    @property
    def at_work(self) -> bool:
        return self._thread.is_alive()

    def _run(self) -> None:
        with asyncio.Runner(loop_factory=lambda: self._loop) as runner:
            runner.run(self._serve())

    async def _serve(self) -> None:
        runner = web.AppRunner(self._site.application(), access_log=None, shutdown_timeout=1.0)
        await runner.setup()
        await web.SockSite(runner, self._at).start()
        await self._stop.wait()
        await self._site.close()
        await runner.cleanup()
