"""The screens in a real browser."""

import socket
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

import pytest

from tests.mavlink.link.builders import Sender, attitude, heartbeat, wait_until
from tests.web.serving import BROWSER, PATIENCE_S, Screen, Serving, a_browser

if TYPE_CHECKING:
    from playwright.sync_api import Browser

LOGS = Path(__file__).parents[2] / "logs"
pytestmark = [
    pytest.mark.xdist_group("browser"),
    pytest.mark.skipif(BROWSER is None, reason="there is no chromium on this system"),
]


@pytest.fixture(scope="module")
def browser() -> Iterator["Browser"]:
    with a_browser() as browser:
        yield browser


@pytest.mark.study
def test_a_log_is_replayed_in_a_page_that_asks_nothing_of_another_host(browser, tmp_path):
    serving = Serving(tmp_path, "replay", LOGS / "bundled-demo.tlog", "--speed", "max")
    try:
        page = Screen(browser, serving.url)
        page.until(lambda: "good manoeuvre, the model explains" in page.text)
        assert {urlsplit(url).netloc for url in page.asked} == {urlsplit(serving.url).netloc}
        assert page.wrong == []
        page.press("q")
        page.until(lambda: page.is_closed)
        wait_until(lambda: serving.children == [], timeout_s=PATIENCE_S)
    finally:
        serving.clear()


def test_two_pages_show_one_campaign_on_one_link_and_nothing_outlives_the_command(browser, tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as vehicle:
        master = f"tcp:127.0.0.1:{vehicle.getsockname()[1]}"
        serving = Serving(tmp_path, "live", "--master", master, "--record", tmp_path / "flight.tlog")
        try:
            link, _ = vehicle.accept()
            for milliseconds in range(0, 2000, 20):
                link.sendall(Sender().pack(heartbeat()) + Sender().pack(attitude(milliseconds)))
            one, other = Screen(browser, serving.url), Screen(browser, serving.url)
            other.press("e", "8")
            other.until(lambda: "8 Log" in other.text)
            one.press("m")
            one.until(lambda: "Mark this moment as" in one.text)
            one.press(*"gust", "Enter")
            other.until(lambda: "gust" in other.text)
            started = serving.children
            assert sorted(name for _, name in started) == [
                "advisor.mavlink.link.keeper",
                "advisor.session.worker",
                "advisor.web.viewer",
                "advisor.web.viewer",
            ]
            vehicle.settimeout(0.1)
            with pytest.raises(TimeoutError):  # nobody has called the vehicle a second time
                vehicle.accept()
            assert serving.interrupt() == 130
            wait_until(
                lambda: not any(Path(f"/proc/{pid}").exists() for pid, _ in started), timeout_s=PATIENCE_S
            )
            one.until(lambda: one.is_closed and other.is_closed)
            assert (tmp_path / "flight.tlog").stat().st_size > 0
            link.close()
        finally:
            serving.clear()
