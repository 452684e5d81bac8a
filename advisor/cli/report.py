"""``advisor report``: one self-contained page about a flight, for people who were not there."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import click

from advisor.cli.options import UNUSABLE, LogsAsked, log_options, refuse_unwritable, writing
from advisor.cli.running import Stages
from advisor.words.problems import ConfigurationError, printable

_NEEDED = ("jinja2", "matplotlib")


@click.command
@log_options("rule", "no_marks", "fixes", "terms")
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), help="File for the page.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["html", "md"]),
    help="Format of the page. Default: md if the file ends in .md, else html.",
)
@click.option(
    "--field",
    "names",
    multiple=True,
    metavar="MESSAGE.FIELD[+...]",
    help="Draw a field of the log, or a sum such as RCOU.C1+RCOU.C3. All fields share one chart. Repeatable.",
)
@click.option("--gap", "with_gap", is_flag=True, help="Diagnose the sim-to-real gap as well.")
def command(asked: LogsAsked, out: Path, form: str | None, names: tuple[str, ...], with_gap: bool) -> int:
    """Write one self-contained page about a flight: verdicts, fits, estimates, flying qualities, telemetry.

    The page needs no network and no script, and prints on A4. Several logs are one campaign.

    \b
    Example:
      advisor report flight.tlog --aircraft my-aircraft.yaml -o report.html
      advisor report battery-1.tlog battery-2.bin --gap -o report.html
      advisor report flight.tlog --format md -o report.md
      advisor report flight.bin --field ATT.Roll --field RCOU.C1+RCOU.C3 -o report.html
      advisor report flight.tlog --term "M:q*abs(q)" -o report.html
    """
    _refuse(asked.inputs, out)
    aircraft = asked.read_aircraft()
    from advisor.analysis.vibration import field_sums
    from advisor.cli.page_content import gather
    from advisor.process.atomic_file import write_atomically
    from advisor.report.page.render import page

    with Stages() as tell:
        fields = {log: field_sums(log, names) for log in asked.logs}
        content, said = gather(asked, aircraft, with_gap, tell, fields=fields)
        tell("drawing the page", 0.9)
        markdown = form == "md" or (form is None and out.suffix.lower() == ".md")
        with writing("-o", out):
            write_atomically(out, page(content, "md" if markdown else "html"))
    for sentence in said:
        click.echo(sentence, err=True)
    click.echo(f"Wrote {printable(str(out))}.", err=True)
    return 0 if content.analysis["usable"] else UNUSABLE


def _refuse(inputs: Sequence[Path], out: Path) -> None:
    """Refuse, before any work, options that would fail after the work."""
    refuse_missing_libraries("advisor report")
    refuse_unwritable("-o", out)
    for given in inputs:
        if out.exists() and given.exists() and out.samefile(given):
            raise ConfigurationError(f"-o: {out} is an input of the report; name another file.")


def refuse_missing_libraries(command: str) -> None:
    """Refuse a command that draws pages where the libraries for pages are missing.

    Raises
    ------
    ConfigurationError
        A library is missing.
    """
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise ConfigurationError(
            f"{command} needs {' and '.join(missing)}: pip install 'inflight-advisor[report]'."
        )
