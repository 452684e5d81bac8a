"""``advisor serve`` behind the TLS proxy of the documentation."""

import http.client
import os
import re
import shutil
import ssl
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from advisor.web.access import Access
from advisor.web.site import Site, WebServer, listening
from tests.web.test_site import NOWHERE, PASSWORD, UPGRADE

NGINX = shutil.which("nginx", path=f"{os.environ['PATH']}:/usr/sbin")
PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "browser.md"


def documented(certificate: Path, key: Path, port: int, server: int) -> str:
    """The documented proxy with this certificate, at a port of its own, before this server."""
    found = re.search(r"```nginx\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert found is not None
    block = found[1]
    for written, here in (
        ("listen 443 ssl", f"listen 127.0.0.1:{port} ssl"),
        ("/etc/ssl/flight.crt", str(certificate)),
        ("/etc/ssl/flight.key", str(key)),
        ("127.0.0.1:8000", f"127.0.0.1:{server}"),
    ):
        assert written in block
        block = block.replace(written, here)
    return block


@contextmanager
def proxied(folder: Path, port: int, server: int) -> Iterator[ssl.SSLContext]:
    """Run nginx, and give the context that trusts its certificate."""
    certificate, key = folder / "flight.crt", folder / "flight.key"
    request = "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=127.0.0.1"
    named = ["-addext", "subjectAltName=IP:127.0.0.1", "-keyout", str(key), "-out", str(certificate)]
    subprocess.run(["openssl", *request.split(), *named], check=True, capture_output=True)
    places = "".join(
        f"{name}_temp_path {folder / name};" for name in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    conf = folder / "nginx.conf"
    conf.write_text(
        f"daemon off; pid {folder / 'nginx.pid'}; error_log stderr; events {{}}\n"
        f"http {{ access_log off; {places}\n{documented(certificate, key, port, server)} }}\n"
    )
    process = subprocess.Popen([str(NGINX), "-p", str(folder), "-c", str(conf)], stderr=subprocess.PIPE)
    try:
        yield ssl.create_default_context(cafile=str(certificate))
    finally:
        process.terminate()
        process.communicate()


class Browser:
    """Calls the proxy over TLS, and keeps the cookie."""

    def __init__(self, port: int, context: ssl.SSLContext) -> None:
        self.origin, self._port, self._context, self._cookie = f"https://127.0.0.1:{port}", port, context, ""

    def call(self, method: str, path: str, body: str | None = None, **headers: str) -> int:
        """Return the status of an answer, as soon as the proxy listens."""
        give_up_s = time.monotonic() + 10.0
        while True:
            connection = http.client.HTTPSConnection(
                "127.0.0.1", self._port, timeout=10, context=self._context
            )
            sent = {"Cookie": self._cookie, "Content-Type": "application/x-www-form-urlencoded", **headers}
            try:
                connection.request(method, path, body, sent)
            except ConnectionRefusedError:
                assert time.monotonic() < give_up_s
                time.sleep(0.05)
                continue
            answer = connection.getresponse()
            self._cookie = (answer.headers["Set-Cookie"] or self._cookie).partition(";")[0]
            connection.close()
            return answer.status


def free_port() -> int:
    with listening("127.0.0.1", 0) as at:
        return int(at.getsockname()[1])


@pytest.mark.skipif(NGINX is None, reason="there is no nginx on this system")
def test_pages_and_their_websocket_pass_the_documented_tls_proxy(tmp_path: Path) -> None:
    port = free_port()
    access = Access(PASSWORD, f"https://127.0.0.1:{port}")
    with (
        listening("127.0.0.1", 0) as at,
        WebServer(Site(access, NOWHERE, "a flight", "closed", 1), at),
        proxied(tmp_path, port, at.getsockname()[1]) as context,
    ):
        browser = Browser(port, context)
        assert browser.call("GET", "/") == 303
        assert browser.call("GET", "/ws", Origin=browser.origin, **UPGRADE) == 403
        assert browser.call("POST", "/login", "password=correct+horse", Origin=browser.origin) == 303
        assert browser.call("GET", "/") == 200
        assert browser.call("GET", "/ws", Origin="https://elsewhere.example", **UPGRADE) == 403
        assert browser.call("GET", "/ws", Origin=browser.origin, **UPGRADE) == 101
