"""The ``advisor`` command: a table of commands, each imported only when it is called."""

import io
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from signal import SIGINT
from typing import TextIO

import click

from advisor import __version__
from advisor.ascii_output import speak_plainly
from advisor.commands.options import INTERNAL, UNUSABLE, USAGE
from advisor.interrupt import STOPPED, Interrupted
from advisor.printable import printable
from advisor.problems import ConfigurationError, UnusableInputError
from advisor.running.threads import pin_linear_algebra

COMMANDS = {
    "demo": "The bundled aircraft flies the paper's campaign over a real link, the advisor advises.",
    "live": "Advise on a live link.",
    "replay": "The same screens on a log, with pause, speed and jump.",
    "analyze": "No screen: every manoeuvre's verdict, the estimates, stop or continue.",
    "gap": "Diagnose why the real aircraft does not fly like the simulator.",
    "export": "Channels, manoeuvres, estimates and residuals for other tools.",
    "batch": "Many flights: every log analyzed once, tables and changes over all of them.",
    "report": "One self-contained page of a flight, for people who were not there.",
    "doctor": "Is this telemetry good enough, before flying; what to change if not.",
    "study": "The paper's simulated campaign: Table 1, Figure 5, Monte-Carlo.",
    "locate": "Where settings and recordings are kept.",
}
"""Name to the line in ``advisor --help``; kept here so that help imports no command."""


class LazyCommands(click.Group):
    """A group whose commands live in ``advisor.commands`` and are imported on demand."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names in the order of a flight test: fly, look back, compare, prepare."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Import one command, or None when there is no such name."""
        if name not in COMMANDS:
            return None
        command = import_module(f"advisor.commands.{name}").command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without importing any."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(cls=LazyCommands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="advisor")
def advisor() -> None:
    """Inflight advisor: was that manoeuvre good, may we stop testing.

    \b
    Example:
      advisor live --master udpin:0.0.0.0:14550 --aircraft my-aircraft.yaml
      advisor analyze flight.tlog --json
    """


def main() -> None:
    """Run the command line; every error a user may meet becomes one sentence and an exit code."""
    pin_linear_algebra()
    speak_plainly()
    code = _ended_by(_run)
    for stream in (sys.stdout, sys.stderr):
        _let_go(stream)
    sys.exit(code)


def _run() -> int:
    """Call the command that the user names; what click would print or exit for is raised instead."""
    with advisor.make_context("advisor", sys.argv[1:]) as context:
        code = advisor.invoke(context)
    sys.stdout.flush()
    return code if isinstance(code, int) else 0


def _ended_by(run: Callable[[], int]) -> int:
    """Exit code of the run, or of the error that has ended the run, which is told."""
    try:
        return run()
    except click.exceptions.Exit as end:
        return end.exit_code
    except click.ClickException as error:
        shown = io.StringIO()
        error.show(shown)
        _tell("\n".join(map(printable, shown.getvalue().rstrip("\n").split("\n"))))
        return USAGE
    except KeyboardInterrupt as end:
        _tell(str(end) or STOPPED)
        return end.code if isinstance(end, Interrupted) else 128 + SIGINT
    except ConfigurationError as error:
        _tell(str(error))
        return USAGE
    except UnusableInputError as error:
        _tell(str(error))
        return UNUSABLE
    except (BrokenPipeError, SystemExit):
        # The reader of our output (head, less) went away, which rich answers with SystemExit.
        return 0
    except OSError as error:
        where = f" ({printable(os.fsdecode(error.filename))})" if error.filename else ""
        _tell(
            f"The system refused: {error.strerror or error}{where}. Make room or give another place, "
            "and repeat."
        )
        return USAGE
    except Exception as error:
        if os.environ.get("ADVISOR_TRACEBACK"):
            raise
        _tell(
            f"A fault of the advisor, not yours: {type(error).__name__}: {printable(str(error))}. "
            "Set ADVISOR_TRACEBACK=1 to see where, and please report it."
        )
        return INTERNAL


def _tell(sentence: str) -> None:
    """Write to standard error, where somebody may listen."""
    with suppress(OSError):
        click.echo(sentence, err=True)


def _let_go(stream: TextIO) -> None:
    """Flush a stream; what nobody can take is thrown away, before the interpreter's end stumbles over it."""
    try:
        stream.flush()
    except OSError:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), stream.fileno())
