"""``advisor serve``: the screens in a browser."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from advisor.cli import live, replay
from advisor.process.interrupt import in_order

if TYPE_CHECKING:
    from advisor.web.serving import PageAddress

F = TypeVar("F", bound=Callable[..., Any])


@click.group
def command() -> None:
    """Show the screens of live and replay in a browser, for several viewers at once.

    Only this computer reaches the pages unless --host names another address. Another address needs a
    password. The password comes from --password-file, from ADVISOR_PASSWORD, or from a prompt.

    \b
    Example:
      advisor serve live --master udpin:0.0.0.0:14550
      advisor serve replay logs/arduplane-calm.tlog --port 8080
      advisor serve live --master udpin:0.0.0.0:14550 --host 0.0.0.0 --password-file crew.txt
    """


def _web_options(command: F) -> F:
    """Add the options of ``advisor.web.serving.place``: the address of the pages, and who may open them."""
    for option in reversed(
        [
            click.option(
                "--host", default="127.0.0.1", show_default=True, help="Address on which pages are served."
            ),
            click.option(
                "--port",
                type=click.IntRange(0, 65535),
                default=8000,
                show_default=True,
                help="Port; 0: any that is free.",
            ),
            click.option(
                "--password-file",
                type=click.Path(path_type=Path),
                metavar="FILE",
                help="The password is the first line of this file.",
            ),
            click.option(
                "--origin",
                metavar="URL",
                help="Address that browsers see, with a TLS proxy before this server: https://flight.example.",
            ),
            click.option(
                "--viewers",
                type=click.IntRange(1, 64),
                default=8,
                show_default=True,
                help="Largest number of pages at once.",
            ),
        ]
    ):
        command = option(command)
    return command


def _placed(options: dict[str, Any], watch_only: bool = False) -> "AbstractContextManager[PageAddress]":
    """Take the options of the web away from those of a command, and reserve the port."""
    from advisor.web.serving import place

    asked = {name: options.pop(name) for name in ("host", "port", "password_file", "origin", "viewers")}
    return place(**asked, watch_only=watch_only)


@command.command("live", params=list(live.command.params))
@_web_options
@click.option(
    "--watch-only", is_flag=True, help="Allow no page to decide by hand or to send requests on the link."
)
def on_link(watch_only: bool, **options: Any) -> None:
    """Advise on a live link, in browsers. All pages show one campaign on one link.

    The link is opened once for all pages, and is recorded as in advisor live. All pages show a mark or an
    exclusion that is made on one page. Closing a page ends nothing. Ctrl-C on this terminal ends the
    campaign.

    \b
    Example:
      advisor serve live --master udpin:0.0.0.0:14550 --aircraft my-aircraft.yaml
      advisor serve live --resume --host 0.0.0.0 --password-file crew.txt --watch-only
    """
    from advisor.web.serving import serve

    assert live.command.callback is not None
    with _placed(options, watch_only) as here:
        live.command.callback(**options, show=partial(serve, here))


@command.command("replay", params=list(replay.command.params))
@_web_options
def of_logs(logs: Sequence[Path], **options: Any) -> None:
    """Replay logs in browsers. Each page has a replay of its own, with its own pause, speed and marks.

    A decision by hand is lost when its page is closed. Nothing is written to the folder of the log.

    \b
    Example:
      advisor serve replay logs/arduplane-calm.tlog --speed 10
    """
    from advisor.web.serving import serve

    assert replay.command.callback is not None
    _refuse_unreadable(logs)
    with _placed(options) as here, in_order():
        replay.command.callback(logs, **options, show=partial(serve, here))


def _refuse_unreadable(logs: Sequence[Path]) -> None:
    """Refuse the logs before a page opens if none of them can be read."""
    from advisor.analysis.marks_file import LogSeries
    from advisor.words.problems import UnusableInputError

    series = LogSeries(logs)
    next(series.batches(), None)
    if len(series.unreadable) == len(logs):
        raise UnusableInputError.of(list(series.unreadable.values()))
