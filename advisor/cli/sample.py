"""``advisor sample``: a flight for trying every command."""

import shlex
import shutil
from pathlib import Path

import click

from advisor.process.installed import SAMPLE, SAMPLES, SLOW_SAMPLE
from advisor.words.problems import ConfigurationError


@click.command
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False), default=Path())
def command(folder: Path) -> None:
    """Write a sample flight and its aircraft file into FOLDER, by default the current one.

    The flight holds seven elevator 3-2-1-1 of an ArduPlane in calm air. A second log has streams that are too
    slow, which doctor reports. Files that exist already are kept.

    \b
    Example:
      advisor sample
      advisor analyze arduplane-calm.tlog --aircraft arduplane-calm.yaml
    """
    log, aircraft = (folder / f"{SAMPLE}{ending}" for ending in (".tlog", ".yaml"))
    slow = folder / f"{SLOW_SAMPLE}.tlog"
    for target in (log, aircraft, slow):
        if target.exists():
            raise ConfigurationError(f"{target} exists: name another folder, e.g. advisor sample trial.")
    folder.mkdir(parents=True, exist_ok=True)
    for target in (log, aircraft, slow):
        shutil.copyfile(SAMPLES / target.name, target)
    click.echo(f"Wrote {log}, {aircraft} and {slow}. Next:")
    for name in ("doctor", "replay", "gap"):
        click.echo(f"  {shlex.join(['advisor', name, str(log), '--aircraft', str(aircraft)])}")
