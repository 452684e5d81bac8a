"""Who is let in, and what a server that nobody has opened a page of yet answers."""

import asyncio
import http.client
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

import pytest
from aiohttp import ClientSession, web
from textual_serve.download_manager import DownloadManager

from advisor.mavlink.link.kept_link import Door
from advisor.web import access
from advisor.web.access import VARIABLE, Access, checked_origin, read_password
from advisor.web.site import PageProcess, Site, WebServer, listening
from advisor.words.problems import ConfigurationError

PASSWORD = "correct horse"
NOWHERE = Door("/nowhere", b"")
UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "MDEyMzQ1Njc4OWFiY2RlZg==",
}


class Caller:
    """Calls one server as a browser does, keeping its cookies."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.own = f"http://127.0.0.1:{port}"
        self.cookie = ""

    def call(
        self, method: str, path: str, body: str | None = None, **headers: str
    ) -> tuple[int, str, http.client.HTTPMessage]:
        """Status, text and headers of an answer; the path is sent as it is."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10.0)
        sent = {"Cookie": self.cookie, "Content-Type": "application/x-www-form-urlencoded", **headers}
        connection.request(method, path, body, sent)
        answer = connection.getresponse()
        text = answer.read().decode()
        connection.close()
        return answer.status, text, answer.headers

    def log_in(self, password: str, origin: str | None = None) -> int:
        """Give a password; the status of the answer."""
        body = f"password={password.replace(' ', '+')}"
        status, _, headers = self.call("POST", "/login", body, Origin=origin or self.own)
        self.cookie = (headers["Set-Cookie"] or "").partition(";")[0]
        return status


@contextmanager
def served(access: Access, most: int = 8) -> Iterator[Caller]:
    """A server at work."""
    with (
        listening("127.0.0.1", 0) as at,
        WebServer(Site(access, NOWHERE, "a <flight>", "closed", most), at),
    ):
        yield Caller(at.getsockname()[1])


@pytest.fixture(scope="module")
def guarded() -> Iterator[Caller]:
    with served(Access(PASSWORD)) as caller:
        yield caller


@pytest.fixture(scope="module")
def own() -> Iterator[Caller]:
    with served(Access()) as caller:
        yield caller


def test_without_the_password_there_is_nothing_but_the_question_for_it(guarded: Caller) -> None:
    guarded.cookie = ""
    status, _, headers = guarded.call("GET", "/")
    assert (status, headers["Location"]) == (303, "/login")
    for path in ("/ws", "/alive", "/download/key", "/nothing"):
        assert guarded.call("GET", path, Origin=guarded.own, **UPGRADE)[0] == 403
    assert 'type="password"' in guarded.call("GET", "/login")[1]


def test_a_wrong_password_is_refused_and_the_right_one_lets_in(guarded: Caller) -> None:
    assert guarded.log_in("wrong horse") == 403
    assert guarded.cookie == ""
    assert guarded.log_in(PASSWORD) == 303
    status, text, _ = guarded.call("GET", "/")
    assert status == 200
    assert "a &lt;flight&gt;" in text


def test_the_right_password_passes_ahead_of_the_guesses_that_wait(guarded: Caller) -> None:
    guesses = [Thread(target=Caller(guarded.port).log_in, args=(f"guess {k}",)) for k in range(4)]
    for guess in guesses:
        guess.start()
    time.sleep(0.2)
    began_s = time.monotonic()
    assert guarded.log_in(PASSWORD) == 303
    assert time.monotonic() - began_s < 0.6
    for guess in guesses:
        guess.join()
    assert time.monotonic() - began_s > 3.0


def test_further_guesses_than_may_wait_are_refused_unseen(guarded, monkeypatch):
    monkeypatch.setattr(access, "MOST_WAITING", 1)
    guess = Thread(target=Caller(guarded.port).log_in, args=("guess",))
    guess.start()
    time.sleep(0.2)
    assert guarded.log_in("another guess") == 429
    guess.join()


def test_a_form_of_another_page_cannot_log_in(guarded: Caller) -> None:
    assert guarded.log_in(PASSWORD, origin="http://elsewhere.example") == 403


@pytest.mark.parametrize("origin", ["http://elsewhere.example", "null", ""])
def test_the_websocket_is_closed_to_other_pages(own: Caller, origin: str) -> None:
    status, _, _ = own.call("GET", "/ws", Origin=origin, **UPGRADE)
    assert status == 403


def test_a_name_that_another_page_gives_to_this_computer_is_refused(own: Caller) -> None:
    assert own.call("GET", "/", Host="elsewhere.example:8000")[0] == 403
    assert own.call("GET", "/", Host="[::1")[0] in (400, 403)
    assert own.call("GET", "/", Host="localhost:9000")[0] == 200


@pytest.mark.parametrize(
    "path", ["/static/../site.py", "/static/%2e%2e/site.py", "/static/..%2fsite.py", "/textual//etc/passwd"]
)
def test_no_path_leads_out_of_the_static_files(own: Caller, path: str) -> None:
    assert own.call("GET", path)[0] in (403, 404)
    assert own.call("GET", "/static/screens.js")[0] == 200


def test_the_browser_is_told_to_load_nothing_from_elsewhere(own: Caller) -> None:
    _, text, headers = own.call("GET", "/")
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    assert "http://" not in text
    assert "https://" not in text


def test_when_all_places_are_taken_a_page_says_so() -> None:
    with served(Access(), most=0) as caller:
        status, text, _ = caller.call("GET", "/")
        assert status == 503
        assert "Every place is taken: 0 at once is the most." in text
        assert caller.call("GET", "/ws", Origin=caller.own, **UPGRADE)[0] == 503


def test_behind_a_proxy_its_address_counts_as_the_own_one() -> None:
    access = Access(PASSWORD, checked_origin("https://Flight.example/"))
    assert access.is_own_page("https://flight.example", "http", "127.0.0.1:8000")
    assert not access.is_own_page("https://flight.example.elsewhere.example", "http", "127.0.0.1:8000")
    with pytest.raises(ConfigurationError, match="without a path"):
        checked_origin("https://flight.example/advisor")


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


@pytest.fixture
def crew(tmp_path: Path) -> Path:
    file = tmp_path / "crew.txt"
    file.write_text("windsock-27\nsecond line\n")
    return file


@pytest.mark.skipif(os.name != "posix", reason="permissions of other users exist on POSIX only")
@pytest.mark.parametrize(
    ("mode", "others_read"),
    [(0o600, False), (0o400, False), (0o640, True), (0o604, True), (0o620, True), (0o610, True)],
)
def test_a_file_that_the_group_or_others_reach_is_named_with_its_mend(crew, capsys, mode, others_read):
    crew.chmod(mode)
    assert read_password(crew, "") == "windsock-27"
    said = f"other users can read {crew}: chmod 600 {crew}\n"
    assert capsys.readouterr().err == (said if others_read else "")


def test_the_variable_gives_the_password_and_is_removed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "from-the-variable")
    assert read_password(None, "") == "from-the-variable"
    assert VARIABLE not in os.environ


def test_a_file_comes_before_the_variable(crew: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    crew.chmod(0o600)
    monkeypatch.setenv(VARIABLE, "from-the-variable")
    assert read_password(crew, "") == "windsock-27"


def test_no_password_is_needed_on_this_computer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert read_password(None, "") is None
