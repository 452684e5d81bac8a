"""A case: a log, what is done to it, and the command that must answer."""

import lzma
import shlex
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from advisor.mavlink.logs.logs import open_log
from benchmarks.endure.forms import FORMS, Word
from benchmarks.endure.packets import Flight, read, seconds, written

ROOT = Path(__file__).parents[2]
FOLDERS = ("logs", "../shared/flights", "../shared/tlogs", "../shared/gate/logs", "../shared/cases")
"""Folders of logs, from the root. Those beside the checkout are used where they are."""
COMMANDS = {"analyze": 0.5, "doctor": 0.2, "live": 0.2, "gap": 0.1}
"""Commands, and the share of the cases that each takes."""
FILE_CUT = "cut-file"
"""The unkindness of a log of another format than telemetry: its bytes end at a share."""


@dataclass(frozen=True)
class Unkindness:
    """A form with its words."""

    form: str
    words: tuple[Word, ...]

    def __str__(self) -> str:
        return " ".join(
            [self.form, *(f"{word:.10g}" if isinstance(word, float) else str(word) for word in self.words)]
        )


@dataclass(frozen=True)
class Case:
    """One question to the advisor."""

    command: str
    log: str
    """Path from the root."""
    named: bool = True
    """Whether the aircraft file of the log is given."""
    unkindnesses: tuple[Unkindness, ...] = ()

    def __str__(self) -> str:
        """Return the text that `parsed` reads."""
        told = f"{self.command} {self.log}{'' if self.named else ' unnamed'}"
        return ": ".join([told, "; ".join(map(str, self.unkindnesses))]) if self.unkindnesses else told

    @property
    def repeat(self) -> str:
        """Command that repeats the case."""
        return f"python -m benchmarks.endure --case {shlex.quote(str(self))}"

    @property
    def aircraft(self) -> Path | None:
        """Aircraft file next to the log."""
        path = ROOT / self.log.removesuffix(".xz")
        file = path.with_suffix(".yaml")
        return file if self.named and file.exists() else None

    def without(self, at: int) -> "Case":
        """Return the case without one unkindness."""
        return replace(self, unkindnesses=self.unkindnesses[:at] + self.unkindnesses[at + 1 :])

    def made(self) -> tuple[bytes, float]:
        """Return the unkind log, and its length in s."""
        sound = whole(self.log)
        if not self.log.removesuffix(".xz").endswith(".tlog"):
            share = float(self.unkindnesses[0].words[0]) if self.unkindnesses else 1.0
            return sound[: round(share * len(sound))], share * other_seconds(self.log)
        flight = packets(self.log)
        if not self.unkindnesses:
            return sound, seconds(flight)
        for one in self.unkindnesses:
            flight = FORMS[one.form].apply(flight, *one.words)
        return written(flight), seconds(flight)


def parsed(text: str) -> Case:
    """Read the text of a case."""
    told, _, unkind = text.partition(": ")
    command, log, *unnamed = told.split()
    found = [one.split() for one in unkind.split("; ") if one]
    return Case(
        command, log, not unnamed, tuple(Unkindness(form, tuple(map(_word, words))) for form, *words in found)
    )


def _word(text: str) -> Word:
    try:
        return float(text)
    except ValueError:
        return text


def logs() -> tuple[str, ...]:
    """Return all logs at hand, those of this repository first."""
    endings = (".tlog", ".tlog.xz", ".bin", ".BIN", ".ulg")
    return tuple(
        f"{folder}/{path.name}"
        for folder in FOLDERS
        for path in sorted((ROOT / folder).glob("*"))
        if path.name.endswith(endings)
    )


@lru_cache(maxsize=8)
def whole(log: str) -> bytes:
    """Return the bytes of a log."""
    data = (ROOT / log).read_bytes()
    return lzma.decompress(data) if log.endswith(".xz") else data


@lru_cache(maxsize=8)
def packets(log: str) -> Flight:
    """Return the packets of a telemetry log."""
    return read(whole(log))


@cache
def other_seconds(log: str) -> float:
    """Return the length of a log of another format, s."""
    arrivals = [
        float(columns.arrival_s[-1]) for batch in open_log(ROOT / log) for columns in batch if len(columns)
    ]
    return max(arrivals) - min(arrivals) if arrivals else 0.0


def draw(seed: int, number: int, of: tuple[str, ...]) -> Case:
    """Draw a case. It depends on its seed, its number and the logs at hand."""
    rng = np.random.default_rng([seed, number])
    command = str(rng.choice(list(COMMANDS), p=list(COMMANDS.values())))
    log, named = str(rng.choice(of)), bool(rng.random() < 0.8)
    if not log.removesuffix(".xz").endswith(".tlog"):
        return Case(command, log, named, (Unkindness(FILE_CUT, (round(float(rng.random()), 4),)),))
    flight = packets(log)
    forms = [str(form) for form in rng.choice(list(FORMS), size=int(rng.integers(1, 4)), replace=False)]
    if "cut" not in forms and rng.random() < 0.6:
        forms.insert(0, "cut")
    return Case(
        command, log, named, tuple(Unkindness(form, tuple(FORMS[form].draw(flight, rng))) for form in forms)
    )
