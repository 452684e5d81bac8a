"""The process of one page, as the page and the server end it."""

import asyncio

from aiohttp import ClientSession, web
from textual_serve.download_manager import DownloadManager

from advisor.mavlink.link.keeping import Door
from advisor.web.server import listening
from advisor.web.site import PageProcess


class Slow(DownloadManager):
    """Cancels the downloads of a page at once, and again only after the page has ended."""

    calls = 0

    async def cancel_app_downloads(self, app_service_id: str) -> None:
        self.calls += 1
        await asyncio.sleep(self.calls - 1.0)
        await super().cancel_app_downloads(app_service_id)


async def ended_by_both() -> list[int | None]:
    """Exit codes of a page's process, after each of two calls at the same time that end it."""
    ended: asyncio.Future[list[int | None]] = asyncio.get_running_loop().create_future()

    async def page(request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse()
        await socket.prepare(request)
        process = PageProcess(Door("/nowhere", b""), socket, Slow())
        await process.start(80, 24)

        async def end() -> int | None:
            await process.end()
            assert process._process is not None
            return process._process.returncode

        ended.set_result(await asyncio.gather(end(), end()))
        return socket

    application = web.Application()
    application.add_routes([web.get("/ws", page)])
    runner = web.AppRunner(application)
    await runner.setup()
    with listening("127.0.0.1", 0) as at:
        await web.SockSite(runner, at).start()
        url = f"http://127.0.0.1:{at.getsockname()[1]}/ws"
        async with ClientSession() as browser, browser.ws_connect(url) as socket:
            await socket.receive(timeout=10.0)  # the browser answers that the page is closed
            codes = await asyncio.wait_for(ended, 10.0)
        await runner.cleanup()
    return codes


def test_a_page_that_is_closed_while_the_server_ends_it_ends_once() -> None:
    codes = asyncio.run(ended_by_both())

    assert None not in codes
