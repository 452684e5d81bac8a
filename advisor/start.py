"""Where the ``advisor`` program begins: what holds for the whole process, before large imports."""

import signal
import sys
import warnings


def main() -> None:
    """Run the command line as a process of its own.

    Ctrl-C ends it with one sentence from here on. Warnings are for those who develop: a user sees none,
    unless ``python -W`` asks for them.
    """
    try:
        from advisor.interrupt import end_at_once

        end_at_once()
    except KeyboardInterrupt:
        print("Stopped.", file=sys.stderr)
        sys.exit(130)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    from advisor.cli import main as run

    try:
        run()
    finally:
        # All is said: the interpreter's own end would otherwise die of a signal without a word.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
