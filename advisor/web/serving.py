"""The screens of one campaign, served to browsers until a signal comes."""

import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.session.conducting import Tempo
from advisor.session.remote import ConductorTask, RemoteConductor
from advisor.web.access import Access, checked_origin, on_this_computer, read_password
from advisor.words.problems import ConfigurationError

LOOK_EVERY_S = 0.2
_LIVE_GOES_ON = "The advisor and its recording continue as long as the command runs."
_REPLAY_IS_OVER = "The replay of this page has ended as well."


@dataclass(frozen=True, slots=True)
class PageAddress:
    """Address of the pages, access to them, and their largest number."""

    at: socket.socket
    access: Access
    url: str
    viewers: int
    watch_only: bool = False


@contextmanager
def place(
    host: str,
    port: int,
    password_file: Path | None,
    origin: str | None,
    viewers: int,
    watch_only: bool = False,
) -> Iterator[PageAddress]:
    """Check the user's options, and reserve the port.

    Raises
    ------
    ConfigurationError
        The extra is not installed, a password is missing or unusable, or the port cannot be taken.
    """
    if find_spec("textual_serve") is None:
        raise ConfigurationError("advisor serve needs textual-serve: pip install 'inflight-advisor[web]'.")
    from advisor.web.site import listening

    seen = checked_origin(origin) if origin else None
    here = on_this_computer(host)
    password = read_password(password_file, "--origin" if seen else "" if here else f"--host {host}")
    with listening(host, port) as at:
        name = socket.gethostname() if host in ("0.0.0.0", "::") else f"[{host}]" if ":" in host else host
        url = seen or f"http://{name}:{at.getsockname()[1]}"
        if not here and not seen:
            click.echo(
                "anyone who listens on the network can read the screens and the password: "
                "put a TLS proxy before this server, and give --origin",
                err=True,
            )
        yield PageAddress(at, Access(password, seen), url, viewers, watch_only)


def serve(
    place: PageAddress, task: ConductorTask, aircraft: Aircraft, title: str, tempo: Tempo | None
) -> None:
    """Serve the screens until a signal comes, or until the campaign on a live link breaks off.

    On a live link all pages show one campaign, which one process estimates. In a replay each page has a
    separate campaign.

    Parameters
    ----------
    tempo
        Start settings of each replay. None: the source is a live link.

    Raises
    ------
    UnusableInputError
        The link can never be used.
    """
    from advisor.tui.settings import load_settings
    from advisor.web.showing import Audience, Showing, Viewing
    from advisor.web.site import Site, WebServer

    viewing = Viewing(aircraft, title, tempo, load_settings(), place.watch_only)
    conductor = partial(RemoteConductor, task)
    with ExitStack() as stack:
        shared = stack.enter_context(Showing(conductor())) if tempo is None else None
        audience = stack.enter_context(Audience(viewing, shared, conductor))
        closed = _REPLAY_IS_OVER if shared is None else _LIVE_GOES_ON
        site = Site(place.access, audience.door, title, closed, place.viewers)
        server = stack.enter_context(WebServer(site, place.at))
        click.echo(f"the screens are at {place.url} (at most {place.viewers} at once); Ctrl-C ends", err=True)
        while server.at_work and (shared is None or shared.at_work):
            time.sleep(LOOK_EVERY_S)
    if shared is not None and shared.failure is not None:
        raise shared.failure
