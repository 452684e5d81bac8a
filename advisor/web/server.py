"""The web server in a separate thread, so that the main thread receives signals."""

import asyncio
import os
import socket
from threading import Thread
from typing import Self

from aiohttp import web

from advisor.web.site import Site
from advisor.words.problems import ConfigurationError


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
