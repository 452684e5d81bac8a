"""``advisor locate``: where the user's files are kept."""

import click

PLACES = ("config", "recordings")


@click.command
@click.argument("what", type=click.Choice(PLACES), default="config")
def command(what: str) -> None:
    """Print where settings (config) or the recordings of live links (recordings) are kept.

    The settings file need not exist; every key in it is optional: theme, screen, keys.

    \b
    Example:
      advisor locate config
      ls "$(advisor locate recordings)"
    """
    if what == "config":
        from advisor.tui.settings import settings_path

        click.echo(settings_path())
    else:
        from advisor.mavlink.recording_file import recordings_folder

        click.echo(recordings_folder())
