"""The improved simulator on manoeuvres that no fit has used: the gap before and after, and a second answer.

Without logs of their own, the last third of the manoeuvres is kept apart. The simulator is improved by the
others, as ``--out`` and ``--export`` improve it. The manoeuvres kept apart are compared with the given
simulator and with the improved simulator.
"""

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import parse_aircraft
from advisor.analysis.gap import GapFlights, compare_flown, named_simulator
from advisor.exports.models.flown import FlownModel, file_of, improved_model
from advisor.exports.models.formats.jsbsim_format import FORMAT as JSBSIM
from advisor.exports.models.proved_finding import NUMBERS, as_it_ended, without
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.candidates.known import less_of_the_servo, together
from advisor.gap.diagnose import Examined
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import Diagnosis, spelled
from advisor.simulators.compare import Compared
from advisor.simulators.contradicted import contradicted
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.taken_back import taken_back_said, unused
from advisor.simulators.unseen import percent_of, sized_without
from advisor.words.problems import UnusableInputError

Progress = Callable[[str, float], None]
LEAST_KEPT, LEAST_FITTED = 2, 3
"""Least number of manoeuvres that are kept apart, and that the improvement is fitted to: one names no
effect, and a search holds one out."""


@dataclass(frozen=True)
class Proof:
    """The gap of manoeuvres that no fit has used."""

    maneuvers: tuple[int, ...]
    before: float
    """Gap of the simulator as given: mean square over the floor's square, minus 1."""
    after: float
    """Gap of the improved simulator."""
    floor: Mapping[str, float]
    """Standard deviation of the residual where nothing was flown, by channel, in the channel's SI unit."""
    by_maneuver: tuple[tuple[int, float, float], ...]
    """Manoeuvre number, gap before, gap after."""
    first: str
    """Answer of the other manoeuvres, which improved the simulator: a verdict, or the effects."""
    second: str | None
    """Verdict on the improved simulator."""
    sentence: str
    """Sentence of the verdict on the improved simulator."""
    not_carried: tuple[str, ...] = ()
    """Parts of the improvement that the simulator cannot take."""
    taken_back: tuple[str, ...] = ()
    """Parts of the improvement with which the gap does not fall: effects, or the fitted numbers."""
    gap_with_them: float | None = None
    """Gap with these parts; None where nothing was taken back."""
    alone: str = ""
    """Sentence of the fitted manoeuvres alone, where they name no correction: that of all manoeuvres was
    flown. Empty otherwise."""

    @property
    def is_closed(self) -> bool:
        """Whether the second answer leaves nothing to add but numbers."""
        return self.second in ("none", "parameters")

    def stays_of(self, found: Diagnosis, given: Mapping[str, float]) -> Diagnosis:
        """Return a diagnosis without the parts that were taken back, which its sentence names.

        Parameters
        ----------
        given
            Derivatives of the simulator as given.
        """
        if self.gap_with_them is None:
            return found
        words = [one if one == NUMBERS else spelled(one) for one in self.taken_back]
        said = taken_back_said(words, unused(self.maneuvers), self.gap_with_them, self.after)
        lead = next(iter(named(found)), NUMBERS)
        for part in self.taken_back:
            found = without(found, part, given)
        if lead in self.taken_back:
            found = contradicted(found, 0.01 * percent_of(self.before, self.after))
            found = replace(found, sentence=" ".join([*found.static, found.sentence, *found.taken_back]))
        return replace(found, taken_back=(*found.taken_back, said), sentence=f"{found.sentence} {said}")


def prove(
    flown: GapFlights,
    fresh: GapFlights | None,
    aircraft: Aircraft,
    target_system: int | None = None,
    progress: Progress = lambda *_: None,
    prior: FieldPrior = FIELD,
    whole: Compared | None = None,
) -> Proof:
    """Improve the simulator by some manoeuvres, and fly others.

    Where these manoeuvres alone name no correction, that of the whole flight is flown, with sizes fitted to
    these manoeuvres alone.

    Parameters
    ----------
    flown
        Manoeuvres of the diagnosis.
    fresh
        Manoeuvres of other logs; None keeps the last third of ``flown`` apart.
    whole
        Comparison of ``flown``.

    Raises
    ------
    UnusableInputError
        There are too few manoeuvres, nothing was improved, or the simulator does not fly.
    """
    fitted, kept = flown, fresh
    if kept is None:
        some, last = parted(flown.maneuvers)
        fitted, kept = replace(flown, maneuvers=list(some)), replace(flown, maneuvers=list(last))

    def part(k: int) -> Progress:
        """Return the progress of one of the three comparisons."""
        return lambda what, share: progress(what, (k + share) / 3.0)

    first = _compared(fitted, aircraft, target_system, part(0), prior)
    found, alone = first.diagnosis, ""
    if fresh is None and not found.improves and whole is not None and whole.findings is not None:
        alone = found.sentence
        examined = Examined(whole.diagnosis, whole.findings)
        found = sized_without(examined, [m.number for m in kept.maneuvers]).diagnosis
    refuse_unimproved(found.improves, alone or found.sentence, len(fitted.maneuvers))
    if fresh is None:
        found = as_it_ended(found, fitted.maneuvers, first.aircraft)

    def asked_again(improved: Diagnosis) -> tuple[Diagnosis, tuple[str, ...]]:
        with tempfile.TemporaryDirectory() as folder:
            better, left = _improved(replace(first, diagnosis=improved), aircraft, Path(folder))
            return _compared(kept, better, target_system, part(2), prior).diagnosis, left

    before = _compared(kept, aircraft, target_system, part(1), prior).diagnosis
    after, left = every, _ = asked_again(found)
    taken: tuple[str, ...] = ()
    if every.gap.before > before.gap.before:
        parts = [*found.effects, NUMBERS]
        tried = [(*asked_again(without(found, part, first.aircraft.model)), (part,)) for part in parts]
        nothing = (before, (), tuple(parts))
        after, left, taken = min((*tried, nothing), key=lambda one: one[0].gap.before)
    was = {number: gap for number, gap, _ in before.gap.by_maneuver}
    now = {number: gap for number, gap, _ in after.gap.by_maneuver}
    return Proof(
        maneuvers=tuple(m.number for m in kept.maneuvers),
        before=before.gap.before,
        after=after.gap.before,
        floor=after.gap.floor,
        by_maneuver=tuple((n, was[n], now[n]) for n in now if n in was),
        first=" + ".join(named(found)) or str(found.verdict),
        second=after.verdict,
        sentence=after.sentence,
        not_carried=left,
        taken_back=taken,
        gap_with_them=every.gap.before if taken else None,
        alone=alone,
    )


def lines_of(proof: Proof) -> Iterator[str]:
    """Yield the proof for people."""
    flown = ", ".join(map(str, proof.maneuvers))
    yield f"Proof on manoeuvres {flown}, which no fit has used: gap {proof.before:.2f} → {proof.after:.2f}"
    for number, before, after in proof.by_maneuver:
        yield f"  manoeuvre {number}: {before:.2f} → {after:.2f}"
    if proof.alone:
        yield "  The correction is that of all manoeuvres; its sizes are fitted without those of the proof."
        yield f"  Without them the flight says: {proof.alone}"
    left = "nothing above the noise" if proof.second == "none" else proof.sentence
    yield f"  asked again, the improved simulator lacks: {left}"
    for one in proof.not_carried:
        yield f"  the simulator does not take {one}"


def parted(maneuvers: Sequence[Maneuver]) -> tuple[Sequence[Maneuver], Sequence[Maneuver]]:
    """Return the manoeuvres of the fit, and the last third.

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
    """Refuse to prove what improves nothing.

    Raises
    ------
    UnusableInputError
        The fit names no cause and no wrong number.
    """
    if not improves:
        raise UnusableInputError(
            "nothing_to_prove",
            f"--prove has no improved simulator to fly. The {count} manoeuvres of its fit say: {sentence}",
            "Leave out --prove, or name the manoeuvres' other half by --prove LOG.",
        )


def named(found: Diagnosis) -> list[str]:
    """Return the names of the effects of an answer."""
    return [cause.effect for cause in found.causes if cause.present]


def _compared(
    flown: GapFlights, aircraft: Aircraft, target_system: int | None, progress: Progress, prior: FieldPrior
) -> Compared:
    with _opened(aircraft, target_system) as simulator:
        return compare_flown(flown, aircraft, simulator, None, progress, prior)


@contextmanager
def _opened(aircraft: Aircraft, target_system: int | None) -> Iterator[LinearSimulator | None]:
    simulator = named_simulator(aircraft, target_system)
    try:
        yield simulator  # type: ignore[misc]
    finally:
        if simulator is not None:
            simulator.close()


def _improved(first: Compared, aircraft: Aircraft, folder: Path) -> tuple[Aircraft, tuple[str, ...]]:
    """Return the aircraft file with the improved simulator, and the parts that the simulator cannot take."""
    found = first.diagnosis
    kind, _, _ = (aircraft.simulator or "linear").partition(":")
    if kind == "linear":
        better = parse_aircraft(file_of(FlownModel(first.aircraft, None, None, found)))
        return replace(better, simulator=aircraft.simulator), ()
    flown, effects = less_of_the_servo(aircraft, together(aircraft.effects, found.effects))
    if kind != "jsbsim":
        numbers = [one.name for one in found.derivatives if one.differs]
        return replace(flown, effects=effects), tuple(numbers)
    given = replace(first.aircraft, simulator=aircraft.simulator, elevator=aircraft.elevator)
    name = Path(str(aircraft.simulator).partition(":")[2]).stem
    file = folder / name / f"{name}.xml"
    file.parent.mkdir()
    made = JSBSIM.made(improved_model(found, given, None), file)
    file.write_text(made.text, encoding="utf-8")
    around = {effect: sizes for effect, sizes in effects.items() if spelled(effect) in made.left_out}
    own = replace(aircraft.elevator, lag_s=0.0, delay_s=0.0)
    better = replace(aircraft, simulator=f"jsbsim:{file}", effects=around, elevator=own)
    return better, tuple(x for x in made.left_out if x not in map(spelled, around))


def document(proof: Proof) -> dict[str, object]:
    """Return the value of ``proof`` in the document."""
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
