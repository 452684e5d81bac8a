"""The rule ``information`` in words: its sentence for pilots, and the numbers of its evidence."""

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.decision.information import Knowledge
from advisor.decision.pooling import DERIVATIVES
from advisor.words.digits import distinct_texts
from advisor.words.quantities import symbol

SPOKEN = {"alpha": "angle of attack", "q": "pitch rate", "a_z": "normal acceleration"}
"""Predicted output to its name for people."""


def sentence(known: Knowledge, stop: bool) -> str:
    """Return the sentence on stop or continue, with its reason."""
    if stop:
        return _stop(known)
    if known.percent >= 100.0:
        return f"CONTINUE: {_held_back(known)}."
    if np.isnan(known.surprise):
        return "CONTINUE: sure enough; one more manoeuvre to check the prediction."
    off = "" if np.isnan(known.missed_percent) else f" (off by {known.missed_percent:.0f} % of its peak)"
    return (
        f"CONTINUE: sure enough, but the newest manoeuvre was not predicted{off}; one more shows which is "
        "right."
    )


def _stop(known: Knowledge) -> str:
    bands = known.prediction_percent
    within = [f"the response is known to {max(bands.values()):.1f} % of its peak"] if bands else []
    if known.named:
        within.append("each named derivative to its tolerance")
    return f"TEST COMPLETE: {', '.join(within)}, and the newest manoeuvre was predicted."


def _held_back(known: Knowledge) -> str:
    name, share = known.holding_back, 0.01 * known.percent
    times, _ = distinct_texts(share, 1.0, 1)
    if name in SPOKEN:
        if np.isinf(share):
            return f"the response in {SPOKEN[name]} cannot be predicted from these manoeuvres"
        size, limit = distinct_texts(share * known.tolerance_percent, known.tolerance_percent, 1)
        return f"the response in {SPOKEN[name]} is known only to {size} % of its peak (limit {limit} %)"
    if np.isinf(share):
        reason = known.not_identifiable.get(name, "cannot be estimated from these manoeuvres")
        return f"{symbol(name)} {reason.removesuffix('.')}"
    return f"the error of {symbol(name)} is {times} times its tolerance"


def evidence(known: Knowledge) -> tuple[str, ...]:
    """Return the numbers of the decision, one line each: bands, shares of the tolerances, and the parameters
    without one."""
    share = known.share
    bands = ", ".join(f"{SPOKEN[name]} {band:.1f} %" for name, band in known.prediction_percent.items())
    named = ", ".join(f"{symbol(name)} {100.0 * share[name]:.0f} %" for name in known.named)
    weak = ", ".join(symbol(PARAMETERS[k]) for k in DERIVATIVES if PARAMETERS[k] not in known.named)
    return tuple(
        f"{what}: {numbers}"
        for what, numbers in (
            (f"95 % band of the response, of its peak (limit {known.tolerance_percent:g} %)", bands),
            ("95 % interval, of its own tolerance (limit 100 %)", named),
            ("judged by the response alone", weak),
        )
        if numbers
    )
