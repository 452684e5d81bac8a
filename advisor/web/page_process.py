"""The process of one page: its start and its end by the server."""

import asyncio
import os
from asyncio.subprocess import PIPE, Process
from contextlib import suppress

from aiohttp import web
from textual_serve.app_service import AppService
from textual_serve.download_manager import DownloadManager

from advisor.mavlink.link.keeping import Door
from advisor.process.children import python_module
from advisor.web.viewing import ADDRESS, KEY


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
