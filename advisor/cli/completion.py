"""``advisor completion``: script for a shell to complete commands, options and files."""

import click
from click.shell_completion import get_completion_class

SHELLS = ("bash", "zsh", "fish")


@click.command
@click.argument("shell", type=click.Choice(SHELLS))
@click.pass_context
def command(context: click.Context, shell: str) -> None:
    """Print the script that makes SHELL complete the advisor's commands, options and files.

    \b
    Example:
      eval "$(advisor completion bash)"          in ~/.bashrc
      eval "$(advisor completion zsh)"           in ~/.zshrc, after compinit
      advisor completion fish | source           in ~/.config/fish/config.fish
    """
    completion = get_completion_class(shell)
    assert completion is not None
    program = context.find_root().command
    click.echo(completion(program, {}, "advisor", "_ADVISOR_COMPLETE").source())
