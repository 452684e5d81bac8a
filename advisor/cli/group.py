"""The ``advisor`` command: a table of commands, each imported only when it is called."""

import io
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from difflib import get_close_matches
from functools import cache, partial, wraps
from importlib import import_module
from signal import SIGINT
from typing import Any, TextIO

import click
from click.shell_completion import CompletionItem, shell_complete

from advisor.cli.options import INTERNAL, UNUSABLE, USAGE
from advisor.process.first_run import compile_once
from advisor.process.interrupt import STOPPED, Interrupted
from advisor.process.tasks.threads import pin_linear_algebra
from advisor.words.problems import ConfigurationError, UnusableInputError, printable, speak_plainly

COMMANDS = {
    "demo": "Fly the bundled aircraft through the paper's campaign over a real link, with advice.",
    "live": "Advise on a live link.",
    "replay": "Play a log on the screens of a live flight, with pause, speed and jump.",
    "serve": "Show the screens of live and replay in a browser, for several viewers.",
    "analyze": "Print every manoeuvre's verdict, the estimates, and stop or continue.",
    "gap": "Diagnose why the real aircraft does not fly like the simulator.",
    "simulator": "Check your own simulator: signs, units, trim and responses.",
    "export": "Write channels, manoeuvres, estimates and residuals for other tools.",
    "batch": "Analyze many logs: one table of flights, one of manoeuvres, changes over time.",
    "expect": "Test a flight: compare a log with a file of expectations, for continuous integration.",
    "report": "Write one self-contained page about a flight, for people who were not there.",
    "doctor": "Check before a flight whether the telemetry is good enough; say what to change.",
    "study": "Repeat the paper's simulated campaign: Table 1, Figure 5, Monte-Carlo.",
    "mcp": "Let an assistant read logs: doctor, analyze, gap and report as tools.",
    "script": "Write the test inputs as a script that the autopilot flies.",
    "aircraft": "Write an aircraft file, or list its missing keys with their cost.",
    "sample": "Put a sample flight and its aircraft file into this folder.",
    "locate": "Print where settings and recordings are kept.",
    "completion": "Print the script that lets a shell complete the advisor's commands.",
}
"""Line in ``advisor --help`` of each command. The lines stand in this module, so that the help imports no
command.
"""


COMPLETION_VARIABLE = "_ADVISOR_COMPLETE"
"""Environment variable with which a shell requests completions."""
WITHOUT_KERNELS = frozenset({"locate", "sample", "aircraft", "completion", "mcp", "simulator"})
"""Commands that need no compiled code, or need it seldom. The first run of such a command
compiles nothing.
"""


class LazyCommands(click.Group):
    """A group whose commands live in ``advisor.cli`` and are imported on demand."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return names in the order of a flight test: fly, look back, compare, prepare."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Import one command; None for an unknown name."""
        return _command(name) if name in COMMANDS else None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that the first word names. An unknown word raises an error that suggests a
        command.

        Raises
        ------
        UsageError
            There is no such command.
        """
        near = get_close_matches(args[0], COMMANDS, 1)
        if args[0] not in COMMANDS and near and not ctx.resilient_parsing:
            ctx.fail(f"No such command {args[0]!r}: did you mean {near[0]}?")
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Complete the name of a command, or an option, without importing any command."""
        if incomplete and not incomplete[0].isalnum():
            return super().shell_complete(ctx, incomplete)
        return [
            CompletionItem(name, help=line) for name, line in COMMANDS.items() if name.startswith(incomplete)
        ]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without importing any."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@cache
def _command(name: str) -> click.Command:
    """Import a command. On the first run, a command that calls compiled code compiles that code first."""
    command = import_module(f"advisor.cli.{name}").command
    assert isinstance(command, click.Command)
    if name not in WITHOUT_KERNELS:
        parts = command.commands.values() if isinstance(command, click.Group) else (command,)
        for part in parts:
            part.callback = part.callback and _compiled_first(part.callback)
    return command


def _compiled_first(run: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(run)
    def compile_and_run(*arguments: Any, **options: Any) -> Any:
        compile_once(partial(click.echo, err=True))
        return run(*arguments, **options)

    return compile_and_run


def _say_version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if not wanted or context.resilient_parsing:
        return
    from advisor import __version__

    click.echo(f"advisor, version {__version__}")
    context.exit()


@click.group(cls=LazyCommands, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_say_version,
    help="Show the version.",
)
def advisor() -> None:
    """Inflight advisor: was that manoeuvre good, may we stop testing, and why does the aircraft not fly like
    our simulator.

    \b
    Example:
      advisor live --master udpin:0.0.0.0:14550 --aircraft my-aircraft.yaml
      advisor analyze flight.tlog --json
    """


def main() -> None:
    """Run the command line. Every error that a user may meet becomes one sentence and an exit code."""
    pin_linear_algebra()
    speak_plainly()
    code = _ended_by(_run)
    for stream in (sys.stdout, sys.stderr):
        _let_go(stream)
    sys.exit(code)


def _run() -> int:
    """Call the command that the user names. Messages and exits that click would handle are raised."""
    if asked := os.environ.get(COMPLETION_VARIABLE):
        return shell_complete(advisor, {}, "advisor", COMPLETION_VARIABLE, asked)
    words = sys.argv[1:]
    if words[:1] == ["help"]:
        words = [*words[1:], "--help"]
    with advisor.make_context("advisor", words) as context:
        code = advisor.invoke(context)
    sys.stdout.flush()
    return code if isinstance(code, int) else 0


def _ended_by(run: Callable[[], int]) -> int:
    """Return the exit code of ``run``. Print the error that ended ``run``, if any."""
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
        if error.__cause__ is not None and os.environ.get("ADVISOR_TRACEBACK"):
            raise
        _tell(str(error))
        return UNUSABLE
    except (BrokenPipeError, SystemExit):
        # The reader of the output (head, less) went away, which rich answers with SystemExit.
        return 0
    except OSError as error:
        where = f" ({printable(os.fsdecode(error.filename))})" if error.filename else ""
        _tell(
            f"The system refused: {error.strerror or error}{where}. Make room or give another place, then "
            f"repeat the command."
        )
        return USAGE
    except Exception as error:
        if os.environ.get("ADVISOR_TRACEBACK"):
            raise
        _tell(
            f"A fault of the advisor, not yours: {type(error).__name__}: {printable(str(error))}. "
            "Set ADVISOR_TRACEBACK=1 to see where, and please report this error."
        )
        return INTERNAL


def _tell(sentence: str) -> None:
    """Write to standard error, unless standard error is closed."""
    with suppress(OSError):
        click.echo(sentence, err=True)


def _let_go(stream: TextIO) -> None:
    """Flush a stream. Drop text that no reader takes any more, so that Python's shutdown does not fail."""
    try:
        stream.flush()
    except OSError:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), stream.fileno())
