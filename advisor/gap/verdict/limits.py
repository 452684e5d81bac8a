"""Limits of the answer of a diagnosis, as sentences for every face."""

from collections.abc import Iterator

from advisor.gap.result import VISIBLE, Diagnosis


def limits_of(d: Diagnosis) -> Iterator[str]:
    """Yield the limits of the answer, which stand next to the answer."""
    if d.verdict != "untested" and not d.derivatives:
        yield "No simulator was given: the answer is about the flight alone."
    air = "The air moved, and its course was fitted to the same samples."
    beyond_air = None if d.shrink is None else d.shrink.beyond_air_percent
    if beyond_air is not None:
        yield f"{air} Beyond the air the gap falls by {beyond_air:.0f} %."
    elif d.gap.by_air > VISIBLE:
        yield f"{air} That flatters the gap after."
    if len(d.maneuvers) == 1:
        yield "One manoeuvre alone proves no cause."
    if d.although_refused:
        numbers = ", ".join(map(str, d.although_refused))
        several = len(d.although_refused) > 1
        used = f"Manoeuvres {numbers} are" if several else f"Manoeuvre {numbers} is"
        yield f"{used} used, although advisor analyze refuses {'them' if several else 'it'}."
