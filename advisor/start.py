"""Entry point of the ``advisor`` program: settings of the whole process, before large imports."""

import signal
import sys
import warnings


def main() -> None:
    """Run the command line as a process of its own.

    Ctrl-C ends the process with one sentence. Warnings are for developers: a user sees none without ``python
    -W``.
    """
    try:
        from advisor.process.interrupt import end_at_once

        end_at_once()
    except KeyboardInterrupt:
        print("Stopped.", file=sys.stderr)
        sys.exit(130)
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    from advisor.cli.group import main as run

    try:
        run()
    finally:
        # All output is written. The interpreter's own shutdown would die of a signal without a word.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
