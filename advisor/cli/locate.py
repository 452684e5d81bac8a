"""``advisor locate``: the places of the user's files."""

import click

PLACES = ("config", "recordings")


@click.command
@click.argument("what", type=click.Choice(PLACES), default="config")
def command(what: str) -> None:
    """Print the path of the settings file (config), or of the folder of live links' recordings (recordings).

    The settings file need not exist. Every key in the file is optional: theme, screen, keys.

    \b
    Example:
      advisor locate config
      ls "$(advisor locate recordings)"
    """
    if what == "config":
        from advisor.tui.settings import settings_path

        click.echo(settings_path())
    else:
        from advisor.mavlink.link.recorder import recordings_folder

        click.echo(recordings_folder())
