"""Texts of a diagnosis: the sentence for pilots, the title, the answers and the limits."""

from collections.abc import Iterator, Sequence

from advisor.gap.alternative import Alternative, AlternativeEvidence, together
from advisor.gap.result import VISIBLE, Cause, Diagnosis, Gap, GapVerdict, Shrink, Where, spelled
from advisor.gap.verdict.statements import or_else, what
from advisor.words.certainty import Answers

_AS_LIKELY = 0.99
"""Words: block score relative to the best block above which both blocks are equally likely."""
BLOCKS = {
    "input": "between the command and the surface",
    "force_equation": "in the lift",
    "moment_equation": "in the pitching moment",
    "air": "in the air",
    "alpha_sensor": "in the angle of attack channel",
    "pitch_rate_sensor": "in the pitch rate channel",
    "accelerometer": "in the accelerometer",
    "attitude_sensor": "in the attitude channel",
    "timing": "in the time stamps",
    "aileron": "between the aileron's command and the aileron",
    "rudder": "between the rudder's command and the rudder",
    "side_force": "in the side force",
    "rolling_moment": "in the rolling moment",
    "yawing_moment": "in the yawing moment",
    "roll_rate_sensor": "in the roll rate channel",
    "yaw_rate_sensor": "in the yaw rate channel",
    "sideslip_sensor": "in the sideslip channel",
}


def place(block: str) -> str:
    """Return the place of a block in words."""
    return BLOCKS[block]


def in_words(alternative: Alternative) -> str:
    """Return the words for an alternative: ``something without a name in the lift``, ``ground effect``."""
    words = {"none": "nothing to correct", "parameters": "wrong numbers"}
    if alternative.kind == "unknown":
        return f"something without a name {place(alternative.block)}"
    return words.get(alternative.kind, spelled(alternative.name))


def sentence_of_one_maneuver(where: Where) -> str:
    """Return the sentence of a single manoeuvre, which shows where a gap lies and proves no cause."""
    return (
        f"Something acts {place(where.block)} that the simulator does not have; one manoeuvre cannot prove "
        "the cause: fly two more."
    )


def sentence_of(
    verdict: GapVerdict,
    gap: Gap,
    where: Where,
    causes: Sequence[Cause],
    shrink: Shrink | None,
    in_simulator: frozenset[str] = frozenset(),
) -> str:
    """Return the sentence for the crew; ``in_simulator`` holds the effects that the aircraft file already
    has."""
    present = [c for c in causes if c.present]
    if verdict == "none":
        return _of_no_gap(gap)
    if verdict == "parameters":
        return _of_wrong_parameters(present, shrink)
    if verdict == "unknown":
        return _of_unknown(where, causes, present)
    return _of_effects(causes, shrink, in_simulator)


def _of_no_gap(gap: Gap) -> str:
    if gap.before < VISIBLE:
        finding = "the gap is within the noise"
    elif gap.by_air > 0.5 * (gap.before - gap.after) and gap.after < 0.5 * gap.before:
        finding = "light gusts, as in every flight, make most of the gap"
    else:
        finding = f"the difference is {gap.before:.2g} of the noise: this flight cannot tell it from noise"
    return f"The simulator flies like the aircraft: {finding}."


def _of_wrong_parameters(present: Sequence[Cause], shrink: Shrink | None) -> str:
    removed = _removed(shrink)
    if shrink is not None and shrink.beyond_air_percent is not None:
        removed = f"{shrink.beyond_air_percent:.0f} % of the gap, and the air makes the rest"
    wrong = f"wrong numbers: the eight fitted derivatives remove {removed}"
    if shrink is not None and shrink.by_numbers_percent is not None and present:
        return f"The simulator has {wrong}; {_listed(present)} explains little of it."
    return f"The simulator has the right structure and {wrong}."


def _of_unknown(where: Where, causes: Sequence[Cause], present: Sequence[Cause]) -> str:
    tried = next(iter(causes), None)
    near = f"; the closest, {spelled(tried.effect)}, is not enough" if tried is not None else ""
    if present:
        near = f", in addition to what looks like {_listed(present)}"
    alike = [place(b) for b, score in where.ranking if b != where.block and score >= _AS_LIKELY]
    places = " or ".join([place(where.block), *alike])
    return f"Something acts {places} that no known effect explains{near}."


def _of_effects(causes: Sequence[Cause], shrink: Shrink | None, in_simulator: frozenset[str]) -> str:
    stays = [c for c in causes if c.present]
    present = stays or causes[:1]
    named = f"{what(present[0], in_simulator)}{or_else(present[0], causes)}"
    beyond_air = None if shrink is None else shrink.beyond_air_percent
    if present[0].block == "air" and len(present) == 1:
        also_wrong = ""
        if beyond_air is not None:
            also_wrong = f"; its parameters are wrong too, and cause {beyond_air:.0f} % of the gap"
        return f"{named}: the air causes this, not the simulator{also_wrong}."
    removed = (
        _removed(shrink) if beyond_air is None else f"{beyond_air:.0f} % of the gap that is not the air's"
    )
    if not stays:
        return f"{named}; the eight fitted derivatives alone remove {removed}."
    added = "adding it"
    if shrink is not None and shrink.by_numbers_percent is not None:
        # The share of fitted derivatives must not pass for the effect's.
        added = "adding it and refitting the eight parameters"
        removed += _numbers_alone(shrink)
    also = f"; also {_listed(present[1:])}" if len(present) > 1 else ""
    return f"{named}; {added} removes {removed}{also}."


def _numbers_alone(shrink: Shrink) -> str:
    """Return a clause about the gap that fitted derivatives alone leave; empty if nothing is left."""
    left, alone = 100.0 - shrink.percent, 100.0 - (shrink.by_numbers_percent or 0.0)
    return f", and numbers alone leave {alone / left:.2g} times as much" if left > 0.0 else ""


def _removed(shrink: Shrink | None) -> str:
    return "the gap" if shrink is None else f"{max(shrink.percent, 0.0):.1f} % of the gap"


def _listed(causes: Sequence[Cause]) -> str:
    return ", ".join(spelled(cause.effect) for cause in causes)


def answers_of(evidence: Sequence[AlternativeEvidence]) -> Answers:
    """Return the answers as texts with their probabilities, the likeliest first."""
    shares = together((e.alternative, e.probability) for e in evidence)
    return [(in_words(alternative), p) for alternative, p in shares]


def limits_of(d: Diagnosis) -> Iterator[str]:
    """Yield the limits of the answer, which the report prints next to it."""
    yield from (str(part.problem) for part in d.failed)
    if d.verdict != "untested" and not d.derivatives:
        yield "No model to compare with: the answer is about the flight alone."
    air = "The air moved, and its course was fitted to the same samples."
    beyond_air = None if d.shrink is None else d.shrink.beyond_air_percent
    if beyond_air is not None:
        yield f"{air} Without the air's part the gap falls by {beyond_air:.0f} %."
    elif d.gap.by_air > VISIBLE:
        yield f"{air} So the gap after the correction looks smaller than it is."
    if len(d.maneuvers) == 1:
        yield "One manoeuvre alone proves no cause."
    if d.although_refused:
        numbers, several = ", ".join(map(str, d.although_refused)), len(d.although_refused) > 1
        used = f"Manoeuvres {numbers} are" if several else f"Manoeuvre {numbers} is"
        yield f"{used} used, although advisor analyze refuses {'them' if several else 'it'}."
