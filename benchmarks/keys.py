"""How long after a key the screen shows its effect, while estimates run.

    python -m benchmarks.keys [--log logs/arduplane-calm.tlog] [--keys 300]

``advisor replay --speed max`` in a pseudo-terminal; a key counts from its first byte written to the
last character of its effect painted. A log that has come to its end is played again from its beginning,
so that the estimating side is busy all the time; keys pressed while it was not are not counted.
"""

import argparse
import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

import numpy as np

from advisor.tui.themes import NAMES
from benchmarks.terminal import terminal

SIZES = ((80, 24), (120, 40), (200, 60))
ESCAPE = b"\x1b[27u"
"""As terminals with the kitty keyboard protocol send it; a lone escape byte waits 100 ms for a sequence."""
PAUSE_S = 0.05
"""Between two keys; a hand is not faster."""

_PANES = (
    "2 Verdict", "3 Parameters", "4 Fit", "9 Residuals", "0 Correlation", "h History",
    "5 Live", "6 Criterion", "7 Channels", "8 Log",
)  # fmt: skip
_ON_THE_SCREEN = ("switch", "pane", "cursor", "zoom", "speed")
"""Keys before which no question or page lies over the screen."""

Shown = Callable[[str], bool]


@dataclass(frozen=True, slots=True)
class Key:
    """A key, what it is for, and how the page looks once it is answered."""

    what: str
    keys: bytes
    answered: Shown


def says(text: str) -> Shown:
    """The page holds a text."""
    return lambda page: text in page


def says_no_more(text: str) -> Shown:
    """The page does not hold it."""
    return lambda page: text not in page


def headed(title: str) -> Shown:
    """A pane's frame carries a title."""
    pattern = re.compile(f"[━─] {re.escape(title)}")
    return lambda page: pattern.search(page) is not None


def dialogue(themes: Iterator[str]) -> Iterator[Key]:
    """One round over the keys, from the engineer's screen and back to it."""
    yield Key("switch", b"p", says("█"))
    yield Key("switch", b"e", headed("1 Manoeuvres"))
    for title in _PANES:
        yield Key("pane", title[:1].encode(), says_focus(title))
        if title == "4 Fit":
            yield Key("cursor", b"\x1b[C", says("━ t "))
            yield Key("zoom", b"z", says("w: whole record"))
            yield Key("zoom", b"w", says_no_more("w: whole record"))
    yield Key("pane", b"\t", says_focus("1 Manoeuvres"))
    yield Key("help", b"?", says("One row for each"))
    yield Key("close help", b"?", says_no_more("One row for each"))
    yield Key("palette", b"\x10", says("Search for commands"))
    yield Key("escape", ESCAPE, says_no_more("Search for commands"))
    yield Key("ask", b"m", says("Mark this moment as"))
    yield Key("type", b"z", says("as: z"))
    yield Key("escape", ESCAPE, says_no_more("Mark this moment as"))
    theme = next(themes)
    yield Key("theme", b"t", says(f"theme: {theme}"))
    yield Key("speed", b"-", says("32 ×"))
    yield Key("speed", b"+", says("  max  "))
    yield Key("pause", b" ", says("❚❚ paused"))
    yield Key("pause", b" ", says_no_more("❚❚ paused"))


def says_focus(title: str) -> Shown:
    """A pane's frame is the heavy one of the focus."""
    return says(f"━ {title}")


def answers(log: Path, size: tuple[int, int], count: int) -> list[tuple[str, float]]:
    """Kind of key and milliseconds to its answer, ``count`` of them."""
    measured: list[tuple[str, float]] = []
    with terminal(str(log), "--speed", "max", size=size, screen="engineer") as here:
        here.until(says("✓ ACCEPTED"), 60.0)
        themes = cycle((*NAMES[1:], NAMES[0]))
        while len(measured) < count:
            for key in dialogue(themes):
                here.watch(PAUSE_S)
                if "end of log" in here.page.text and key.what in _ON_THE_SCREEN:
                    here.press(b"[")
                    here.until(says_no_more("end of log"))
                here.press(key.keys)
                measured.append((key.what, here.until(key.answered) * 1e3))
    return measured


def main(arguments: Sequence[str] | None = None) -> None:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--log", type=Path, default=Path("logs/arduplane-calm.tlog"))
    options.add_argument("--keys", type=int, default=300)
    chosen = options.parse_args(arguments)
    for size in SIZES:
        kinds: dict[str, list[float]] = defaultdict(list)
        for kind, ms in answers(chosen.log, size, chosen.keys // len(SIZES)):
            kinds[kind].append(ms)
            kinds["all"].append(ms)
        for kind, ms in kinds.items():
            print(
                f"{size[0]}x{size[1]}  {kind:<16}{len(ms):>4} keys  median {np.median(ms):6.0f} ms"
                f"  95 % {np.percentile(ms, 95):6.0f}  worst {max(ms):6.0f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
