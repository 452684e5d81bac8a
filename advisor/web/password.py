"""Source of the password: a file, the environment, or a prompt; never the command line."""

import os
import sys
from pathlib import Path

import click

from advisor.words.problems import ConfigurationError

VARIABLE = "ADVISOR_PASSWORD"
SHORTEST = 8
"""Least length of the password. At one guess a second, eight random letters or digits outlast every
campaign."""


def read_password(file: Path | None, needed_for: str) -> str | None:
    """Return the password of the pages.

    Parameters
    ----------
    file
        File whose first line is the password; None: the environment variable, else a prompt.
    needed_for
        Option that makes a password necessary, as the user wrote it. Empty: the password may be missing.

    Raises
    ------
    ConfigurationError
        The file cannot be read, the password is too short, or one is needed and nobody can be asked.
    """
    # Removed from the environment, because no process started here needs the password.
    given = os.environ.pop(VARIABLE, None)
    if file is not None:
        return _long_enough(_first_line(file), f"--password-file {file}")
    if given:
        return _long_enough(given, VARIABLE)
    if not needed_for:
        return None
    if not sys.stdin.isatty():
        raise ConfigurationError(
            f"{needed_for} opens the pages to other computers and needs a password: "
            f"give --password-file FILE, or set {VARIABLE}."
        )
    asked: str = click.prompt("Password of the pages", hide_input=True, confirmation_prompt=True, err=True)
    return _long_enough(asked, "This password")


def _first_line(file: Path) -> str:
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text"
        raise ConfigurationError(
            f"--password-file {file} cannot be read: {reason}; name another file."
        ) from error
    if os.name == "posix" and file.stat().st_mode & 0o077:
        click.echo(f"other users can read {file}: chmod 600 {file}", err=True)
    return text.splitlines()[0] if text else ""


def _long_enough(password: str, where: str) -> str:
    if len(password) < SHORTEST:
        raise ConfigurationError(
            f"{where} holds {len(password)} characters; a password of the pages has at least {SHORTEST}."
        )
    return password
