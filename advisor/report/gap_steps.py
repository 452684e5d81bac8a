"""Next steps after a diagnosis, with the command of each step."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scipy.special import expit

from advisor.gap.alternative import Contribution, together
from advisor.gap.candidates.distinguish import way_to_distinguish
from advisor.gap.effects import EFFECTS
from advisor.gap.result import Cause, Diagnosis, spelled
from advisor.gap.verdict.text import answers_of
from advisor.report.facts.gap import changed
from advisor.report.facts.reasons import in_percent
from advisor.report.facts.sizes import short, sizes_of
from advisor.report.improved import improved_name
from advisor.words.certainty import Answers, doubt_of, is_decided

_PROVE = "Prove the change: {after} again, then on manoeuvres that no fit has used."
_FLY = "fly the same number of manoeuvres again, with another time unit and another amplitude"
_TELLS = 0.1
"""Absolute log odds of the fit, nats, below which repeated manoeuvres would not decide."""


@dataclass(frozen=True, slots=True)
class GapStep:
    """One step to take after a diagnosis."""

    text: str
    command: str = ""
    """Command line for the step; empty without a command."""


def next_steps(
    d: Diagnosis,
    logs: Sequence[str],
    aircraft_file: str | None,
    simulator: str | None = None,
    options: Sequence[str] = (),
    written: str | None = None,
) -> list[GapStep]:
    """Return the steps: a change of the simulator, its proof, and a test against the rival.

    Parameters
    ----------
    aircraft_file
        Aircraft file as the user gave it; None without one.
    simulator
        Specification of the simulator; None if the aircraft file's model is the simulator.
    written
        File of the improved simulator that already exists, so that no step writes it.
    """
    steps = []
    answers = answers_of(d.evidence)
    if doubt_of(answers):
        return [to_decide(answers, _way_of(d), d.why)]
    if what := _to_put(d):
        read = ["advisor", "gap", *logs, *options]
        better = written or improved_name(d, aircraft_file)
        write, proved, formats = _improvement(better, aircraft_file, simulator)
        if written is None:
            command = shlex.join([*read, *write]) if write else ""
            lacks = " what it lacks" if _effects_of(d) else ""
            put = f"Put into the simulator{lacks}" if d.derivatives else "Add to what the file states"
            steps.append(GapStep(f"{put}: {what}.{formats}", command))
        prove = shlex.join([*read, *proved])
        steps.append(GapStep(_PROVE.format(after=short(d.gap.after)), prove))
    if d.missing_law is not None and d.missing_law.term:
        aircraft = ["--aircraft", aircraft_file] if aircraft_file else []
        term = ["advisor", "analyze", *logs, *options, *aircraft, "--term", d.missing_law.term]
        steps.append(GapStep("Estimate the missing law as one more term:", shlex.join(term)))
    rival = _against_the_rival(d) if d.verdict != "none" else ""
    if rival:
        steps.append(GapStep(rival))
    return steps


def _improvement(
    better: str, aircraft_file: str | None, simulator: str | None
) -> tuple[list[str], list[str], str]:
    """Return the options that write and fly the improved simulator, and a sentence about other formats."""
    aircraft = ["--aircraft", aircraft_file] if aircraft_file else []
    kind, _, _ = (simulator or "linear").partition(":")
    if kind == "linear":
        linear = ["--simulator", "linear"] if simulator else []
        write = [*aircraft, *linear, "--out", better]
        return write, [*aircraft, *linear, "--prove"], " --export writes other formats."
    own = [*aircraft, "--simulator", str(simulator)]
    if kind != "jsbsim":
        return [], [*own, "--prove"], ""
    model = str(Path(better).with_suffix(".xml"))
    return [*own, "--export", f"jsbsim:{model}"], [*own, "--prove"], ""


def to_decide(answers: Answers, way: str = "", why: Sequence[Contribution] = ()) -> GapStep:
    """Return the flight that distinguishes the two likeliest answers, with the expected probability.

    Log odds add up, so an equal number of new manoeuvres adds the fit's log odds once more.
    """
    (ours, _), (other, _) = answers[:2]
    step = f"To separate {ours} from {other}: {way or _FLY}."
    fit = sum(part.nats for part in why if part.name == "fit")
    odds = sum(part.nats for part in why) + fit
    if abs(fit) < _TELLS:
        return GapStep(step)
    likelier, p = (ours, expit(odds)) if odds >= 0.0 else (other, expit(-odds))
    return GapStep(
        f"{step} The same number of manoeuvres is expected to raise {likelier} to {in_percent(p)} between "
        f"these two."
    )


def steps_to_decide(d: Diagnosis) -> list[GapStep]:
    """Return the flight that distinguishes the two likeliest answers; empty for a decided answer."""
    answers = answers_of(d.evidence)
    return [to_decide(answers, _way_of(d))] if answers and not is_decided(answers) else []


def _way_of(d: Diagnosis) -> str:
    """Return the measurement that distinguishes the two likeliest effects; empty if none is known."""
    shares = ((e.alternative, e.probability) for e in d.evidence)
    effects = {cause.name: cause.effect for cause in d.causes}
    ours, other = (effects.get(alternative.name, alternative.name) for alternative, _ in together(shares)[:2])
    return way_to_distinguish(ours, other) if {ours, other} <= EFFECTS.keys() else ""


def _to_put(d: Diagnosis) -> str:
    """Return the effects or derivatives to change in the improved simulator; empty if there are none.

    The list omits the air of the day, which no simulator should contain.
    """
    if not d.improves:
        return ""
    effects = [f"{spelled(c.effect)} {', '.join(sizes_of(c.parameters))}" for c in _effects_of(d)]
    numbers = [changed(derivative) for derivative in d.derivatives if derivative.differs]
    in_air = any(c.present and c.block == "air" for c in d.causes)
    return ", ".join(effects or numbers) or ("" if in_air else "the fitted derivatives")


def _effects_of(d: Diagnosis) -> list[Cause]:
    """Return the effects of the answer that a simulator can contain."""
    return [c for c in d.causes if c.present and c.block != "air"] if d.verdict == "effect" else []


def _against_the_rival(d: Diagnosis) -> str:
    """Return the measurement that distinguishes the answer from a similar effect, or shows a hidden one."""
    telling = next((c for c in d.causes if c.present and c.cannot_be_told_from and c.tell_apart_by), None)
    if telling is not None:
        rivals = " or ".join(map(spelled, telling.cannot_be_told_from))
        return f"To exclude {rivals}: {telling.tell_apart_by}."
    if d.verdict == "unknown":
        lists = "; advisor gap --all lists what to log" if d.cannot_see else ""
        return f"To find the cause: fly two more manoeuvres of other amplitude{lists}."
    hidden = next(iter(d.cannot_see), None)
    return f"To see {spelled(hidden.effect)} as well: {hidden.would_need}." if hidden is not None else ""
