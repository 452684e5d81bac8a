"""The ``advisor`` command: a table of commands, each imported only when it is called."""

import os
import sys
from importlib import import_module

import click

from advisor import __version__
from advisor.commands.options import INTERNAL, UNUSABLE, USAGE
from advisor.problems import ConfigurationError, UnusableInputError

COMMANDS = {
    "demo": "The bundled aircraft flies the paper's campaign over a real link, the advisor advises.",
    "live": "Advise on a live link.",
    "replay": "The same screens on a log, with pause, speed and jump.",
    "analyze": "No screen: every manoeuvre's verdict, the estimates, stop or continue.",
    "gap": "Diagnose why the real aircraft does not fly like the simulator.",
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
    # Matrices here are small: threads of the linear algebra library cost far more than they bring.
    for library in ("OPENBLAS", "OMP", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    try:
        code = advisor(standalone_mode=False)
    except click.ClickException as error:
        error.show()
        code = USAGE
    except (click.Abort, KeyboardInterrupt):
        click.echo("stopped", err=True)
        code = 130
    except ConfigurationError as error:
        click.echo(str(error), err=True)
        code = USAGE
    except UnusableInputError as error:
        click.echo(str(error), err=True)
        code = UNUSABLE
    except BrokenPipeError:
        # The reader of our output (head, less) went away; there is nobody left to tell.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    except OSError as error:
        where = f" ({error.filename})" if error.filename else ""
        click.echo(
            f"The system refused: {error.strerror or error}{where}. Make room or give another place, "
            "and repeat.",
            err=True,
        )
        code = INTERNAL
    except Exception as error:
        if os.environ.get("ADVISOR_TRACEBACK"):
            raise
        click.echo(
            f"A fault of the advisor, not yours: {type(error).__name__}: {error}. "
            "Set ADVISOR_TRACEBACK=1 to see where, and please report it.",
            err=True,
        )
        code = INTERNAL
    sys.exit(code if isinstance(code, int) else 0)
