"""Judgement of one answer against the truth of its case.

The truth of a case has the keys

- ``kind``: ``one`` named effect, ``two``, ``none``, ``parameters`` (the file's numbers are off), ``outside``
  (an effect without a name), ``simulator`` (the file names a user's own simulator);
- ``condition``: difficulty of the flight in one word: ``clean``, ``hard``, ``JSBSim``, ...;
- ``effects``: each withheld effect with its sizes, in the contract's names and units;
- ``blocks``: the block of each effect;
- ``gap``: the structural gap above the noise; None if the generator does not measure it;
- ``background``: effects of the flight in addition to the withheld ones;
- ``also_true``: effects that the log has because of its generation.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

NO_ANSWER = "no answer"
"""Verdict of a case without a usable answer. An empty answer is never right, so that silence has no
advantage."""
QUIET = ("none", None)
"""Verdicts without a claim. The verdict is ``null`` if no simulator is given."""
LEFT_ALONE = ("none", "parameters")
"""Verdicts that call the structure of a simulator right."""
Z95 = 1.959964


@dataclass(frozen=True)
class Judged:
    """Truth of a case with its answer."""

    kind: str
    condition: str
    truth: tuple[str, ...]
    blocks: tuple[str, ...]
    sizes: Mapping[str, Mapping[str, float]]
    gap: float | None
    background: tuple[str, ...]
    also_true: tuple[str, ...]
    verdict: str | None
    named: tuple[str, ...]
    """Effects in ``causes``, best first."""
    added: tuple[str, ...]
    """Effects in the answer's waterfall."""
    probability: float
    parameters: Mapping[str, Mapping[str, float]]
    """Parameters of the first cause, with value and error."""
    confusions: tuple[str, ...]
    block: str
    shrink_percent: float
    simulator_percent: float
    """Shrinkage of the gap in the user's own simulator, percent. NaN without a user's simulator."""

    @property
    def first(self) -> str | None:
        """Effect that the verdict names; None for any other verdict than ``effect``."""
        return self.named[0] if self.verdict == "effect" and self.named else None

    @property
    def names_the_cause(self) -> bool:
        """Whether the first cause is the true one. Without an effect, moving air is the true cause."""
        truth = self.truth or self.background
        return bool(truth) and self.first == truth[0]

    @property
    def names_what_acted(self) -> bool:
        """Whether the first cause acted on the flight: the drawn effect, or the air."""
        return self.names_the_cause or self.first in self.background

    @property
    def names_or_confuses(self) -> bool:
        """Whether the true cause is first, or stated as indistinguishable from the first."""
        return self.names_the_cause or (self.first is not None and self.truth[0] in self.confusions)

    @property
    def is_alarm(self) -> bool:
        """Whether the answer claims something false. A claim of background turbulence is allowed."""
        return self.verdict not in QUIET and not self.names_what_acted

    @property
    def names_both(self) -> bool:
        """Whether the first cause and the waterfall contain all withheld effects; an alternative does not
        count."""
        return self.first is not None and set(self.truth) <= {self.first, *self.added}

    @property
    def finds_the_block(self) -> bool:
        """Whether the answer names a block in which an effect acts."""
        return self.block in self.blocks

    @property
    def is_left_alone(self) -> bool:
        """Whether the answer calls a simulator of right structure right, or wrong only in its derivatives."""
        return not self.truth and self.verdict in LEFT_ALONE

    @property
    def is_right(self) -> bool:
        """Whether the answer is right for the case's kind: a cause, both, the block, derivatives, or
        nothing."""
        return {
            "none": not self.is_alarm,
            "parameters": self.verdict == "parameters",
            "outside": self.verdict == "unknown" and self.finds_the_block,
            "two": self.names_both,
            "simulator": self.names_the_cause or self.is_left_alone,
        }.get(self.kind, self.names_the_cause)

    def sizes_inside(self) -> list[bool]:
        """Return whether the answer's 95 % interval contains the true size, for each size that it states."""
        return [
            abs(float(said["value"]) - true) <= Z95 * float(said["std"])
            for name, true in self.sizes[self.truth[0]].items()
            if (said := self.parameters.get(name)) and said.get("std") is not None
        ]


def judge(truth: Mapping[str, Any], answer: Mapping[str, Any]) -> Judged:
    """Compare an answer (a document of ``advisor gap --json``) with the truth. An empty answer is treated as
    no answer."""
    usable = bool(answer) and answer.get("usable") is not False
    causes = (answer.get("causes") or []) if usable else []
    first = causes[0] if causes else {}
    shrunk = answer.get("shrink") or {}
    return Judged(
        kind=truth["kind"],
        condition=truth["condition"],
        truth=tuple(truth["effects"]),
        blocks=tuple(truth["blocks"]),
        sizes=truth["effects"],
        gap=truth["gap"],
        background=tuple(truth["background"]),
        also_true=tuple(truth.get("also_true", ())),
        verdict=answer.get("verdict", NO_ANSWER) if usable else NO_ANSWER,
        named=tuple(str(cause.get("effect")) for cause in causes),
        added=tuple(str(step.get("effect")) for step in answer.get("waterfall") or []),
        probability=float(first.get("probability") or 0.0),
        parameters=first.get("parameters") or {},
        confusions=tuple(first.get("cannot_be_told_from") or ()),
        block=str((answer.get("where") or {}).get("block", "")),
        shrink_percent=_percent(shrunk),
        simulator_percent=_percent(shrunk.get("in_simulator") or {}),
    )


def _percent(shrunk: Mapping[str, Any]) -> float:
    percent = shrunk.get("percent")
    return math.nan if percent is None else float(percent)
