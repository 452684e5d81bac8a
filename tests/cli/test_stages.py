"""The line of progress, with the time at which the work ends."""

import io
import sys
import time

from advisor.cli.running import Stages


class Terminal(io.StringIO):
    """A standard error that is watched."""

    def isatty(self) -> bool:
        return True


def test_the_line_says_when_the_work_ends_once_a_tenth_is_done(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    now = [1000.0]
    tell = Stages(clock=lambda: now[0])

    def line(share: float) -> str:
        tell("flying", share)
        return sys.stderr.getvalue().rpartition("\x1b[K")[2]

    def at(when: float) -> str:
        return time.strftime("%H:%M:%S", time.localtime(when))

    now[0] = 1001.0
    assert line(0.09) == "  9 %  flying"
    now[0] = 1005.0
    assert line(0.25) == f" 25 %  flying, ends at about {at(1020.0)}"
    # Another piece of work has its own beginning.
    assert line(0.0) == "  0 %  flying"
    now[0] = 1009.0
    assert line(0.5) == f" 50 %  flying, ends at about {at(1013.0)}"
