"""Test of the improved simulator on unused manoeuvres: the gap before and after, and a second answer.

Without further logs, the last third of the manoeuvres is held out. The other manoeuvres improve the
simulator, as ``--out`` and ``--export`` do. One procedure decides for both axes which parts of the
improvement are kept. Each axis simulates the held-out manoeuvres (``ImprovedAxis``).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.result import Diagnosis, spelled
from advisor.simulators.unseen import taken_back_said, unused
from advisor.words.problems import UnusableInputError
from advisor.words.quantities import maneuvers_said, significant

NUMBERS = "the fitted numbers"
"""Name of the fitted derivatives as one part of an improvement."""
LEAST_KEPT, LEAST_FITTED = 2, 3
"""Least number of held-out manoeuvres, and least number of manoeuvres for the fit."""


@dataclass(frozen=True)
class Kept:
    """Held-out manoeuvres compared with one simulator."""

    gap: float
    """Mean gap over channels and manoeuvres: mean square error over the floor's square, minus 1."""
    by_maneuver: Mapping[int, float]
    """Gap of each held-out manoeuvre, by manoeuvre number."""
    floor: Mapping[str, float]
    answer: Callable[[], tuple[str | None, str]]
    """Function that returns the verdict on the simulator, and its sentence."""
    not_carried: tuple[str, ...] = ()
    """Parts of the improvement that the simulator does not support."""


@dataclass(frozen=True)
class ImprovedAxis:
    """Simulator of one axis that some manoeuvres improved."""

    first: str
    """Answer from the fitted manoeuvres: a verdict, or the effects."""
    parts: tuple[str, ...]
    """Parts of the improvement: effects, then the fitted derivatives."""
    fewer: Sequence[tuple[str, ...]]
    """Sets of parts that may be withdrawn while others are kept."""
    flown: Callable[[tuple[str, ...]], Kept]
    """Function that simulates the held-out manoeuvres without some parts. Without all parts the simulator
    flies as given.
    """
    alone: str = ""
    """Sentence from the fitted manoeuvres alone, if these give no correction and the correction of all
    manoeuvres was used. Empty otherwise.
    """


@dataclass(frozen=True)
class Proof:
    """Gap on manoeuvres that no fit has used, before and after the improvement."""

    maneuvers: tuple[int, ...]
    before: float
    """Gap of the simulator as given: mean square over the floor's square, minus 1."""
    after: float
    """Gap of the improved simulator."""
    floor: Mapping[str, float]
    """Standard deviation of the residual in quiet stretches, by channel, SI."""
    by_maneuver: tuple[tuple[int, float, float], ...]
    """Number of each held-out manoeuvre, with its gap before and after."""
    first: str
    parts: tuple[str, ...]
    """Parts of the improvement: effects, then the fitted derivatives."""
    second: str | None
    """Verdict on the improved simulator."""
    sentence: str
    """Sentence of the verdict on the improved simulator."""
    not_carried: tuple[str, ...] = ()
    """Parts of the improvement that the simulator does not support."""
    taken_back: tuple[str, ...] = ()
    """Parts of the improvement that do not lower the gap: effects, or the fitted derivatives."""
    gap_with_them: float | None = None
    """Gap with the withdrawn parts; None if nothing was withdrawn."""
    alone: str = ""

    @property
    def is_closed(self) -> bool:
        """Whether the second answer leaves at most derivatives to correct."""
        return self.second in ("none", "parameters")

    @property
    def taken_back_said(self) -> str:
        """Sentence about the withdrawn parts; empty if all are kept."""
        if self.gap_with_them is None:
            return ""
        parts = [spelled(part) for part in self.taken_back]
        return taken_back_said(parts, unused(self.maneuvers), self.gap_with_them, self.after)


def proved(axis: ImprovedAxis) -> Proof:
    """Return the gap on held-out manoeuvres, with those parts of the improvement that do not
    raise the gap.
    """
    before, every = axis.flown(axis.parts), axis.flown(())
    after = every
    taken: tuple[str, ...] = ()
    if every.gap > before.gap:
        tried = [(axis.flown(parts), parts) for parts in axis.fewer]
        after, taken = min((*tried, (before, axis.parts)), key=lambda trial: trial[0].gap)
    second, sentence = after.answer()
    was, now = before.by_maneuver, after.by_maneuver
    return Proof(
        maneuvers=tuple(before.by_maneuver), before=before.gap, after=after.gap, floor=after.floor,
        by_maneuver=tuple((n, was[n], now[n]) for n in now if n in was),
        first=axis.first, parts=axis.parts, second=second, sentence=sentence, not_carried=after.not_carried,
        taken_back=taken, gap_with_them=every.gap if taken else None, alone=axis.alone,
    )  # fmt: skip


def answer_of(diagnosis: Diagnosis) -> str:
    """Return the effects of a diagnosis by their names, or its verdict without one."""
    return " + ".join(cause.name for cause in diagnosis.causes if cause.present) or str(diagnosis.verdict)


def without(diagnosis: Diagnosis, part: str, given: Mapping[str, float]) -> Diagnosis:
    """Return a diagnosis whose improved simulator lacks one effect, or has the derivatives as given."""
    if part == NUMBERS:
        own = {name: replace(x, value=given.get(name, x.value)) for name, x in diagnosis.model.items()}
        return replace(diagnosis, model=own, derivatives=())
    effects = {effect: size for effect, size in diagnosis.effects.items() if effect != part}
    causes = tuple(replace(c, present=c.present and c.name != part) for c in diagnosis.causes)
    return replace(diagnosis, effects=effects, causes=causes)


def stays_of(proof: Proof | None, diagnosis: Diagnosis, given: Mapping[str, float]) -> Diagnosis:
    """Return a diagnosis whose improved simulator lacks the withdrawn parts, which its sentence names.

    The posterior stays unchanged, because a proof moves no probability.
    """
    if proof is None or not (said := proof.taken_back_said):
        return diagnosis
    for part in proof.taken_back:
        diagnosis = without(diagnosis, part, given)
    corrects = diagnosis.corrects and len(proof.taken_back) < len(proof.parts)
    taken = (*diagnosis.taken_back, said)
    return replace(diagnosis, taken_back=taken, sentence=f"{diagnosis.sentence} {said}", corrects=corrects)


def lines_of(proof: Proof) -> Iterator[str]:
    """Yield the proof for people."""
    flown = maneuvers_said(proof.maneuvers)
    yield f"Proof on {flown}, which no fit has used: gap {_gaps(proof.before, proof.after)}"
    for number, before, after in proof.by_maneuver:
        yield f"  manoeuvre {number}: {_gaps(before, after)}"
    if proof.alone:
        yield "  The correction is that of all manoeuvres; its sizes are fitted without those flown here."
        yield f"  Without them the flight says: {proof.alone}"
    left = "nothing above the noise" if proof.second == "none" else proof.sentence
    yield f"  asked again, the improved simulator lacks: {left}"
    for part in proof.not_carried:
        yield f"  the simulator does not take {part}"


def _gaps(before: float, after: float) -> str:
    return f"{significant(before, 3)} → {significant(after, 3)}"


def parted(maneuvers: Sequence[Maneuver]) -> tuple[Sequence[Maneuver], Sequence[Maneuver]]:
    """Return the manoeuvres for the fit, and the held-out last third.

    Raises
    ------
    UnusableInputError
        There are too few manoeuvres.
    """
    count = len(maneuvers)
    kept = max(count // 3, LEAST_KEPT)
    if count - kept < LEAST_FITTED:
        raise UnusableInputError(
            "too_few",
            f"--prove keeps {kept} of {count} manoeuvres apart, and {LEAST_FITTED} are needed for the fit.",
            f"Fly {LEAST_KEPT + LEAST_FITTED} manoeuvres, or name another log: --prove LOG.",
        )
    return maneuvers[:-kept], maneuvers[-kept:]


def refuse_unimproved(improves: bool, sentence: str, count: int) -> None:
    """Refuse a proof without an improvement.

    Raises
    ------
    UnusableInputError
        The fit gives no cause and no wrong derivative.
    """
    if not improves:
        raise UnusableInputError(
            "nothing_to_prove",
            f"--prove has no improved simulator to fly. The {count} manoeuvres of its fit say: {sentence}",
            "Leave out --prove, or give a log with other manoeuvres: --prove LOG.",
        )


def document(proof: Proof) -> dict[str, object]:
    """Return the value of the key ``proof`` in the document."""
    return {
        "maneuvers": list(proof.maneuvers),
        "before": proof.before,
        "after": proof.after,
        "floor": dict(proof.floor),
        "by_maneuver": [
            {"number": number, "before": before, "after": after}
            for number, before, after in proof.by_maneuver
        ],
        "second": {"verdict": proof.second, "sentence": proof.sentence},
        "closed": proof.is_closed,
        "not_carried": list(proof.not_carried),
        "taken_back": list(proof.taken_back),
        "fit_alone": proof.alone or None,
    }
