"""Examination of the instruments of roll and yaw of one record.

The order is: roll rate and bank, unit of the specific force, clock of the roll rate, sideslip, side force.
"""

from collections.abc import Mapping
from math import exp, log, pi

from advisor.flight.instruments.examination import FORCE_UNITS_M_S2, hold_force_unit, stated_force_unit
from advisor.flight.instruments.measured import ANY, AS_STATED, EXCLUDED, Evidence, Measured, weigh
from advisor.flight.instruments.side_evidence import (
    force_against_motion,
    rate_against_bank,
    sideslip_against_motion,
)
from advisor.flight.instruments.work import PLAIN, REVERSED, SIGMAS, Examined, Work, hold_clocks, with_error
from advisor.flight.signals.record import Channel

_GYRO_WIDTH = 0.05
"""Standard deviation of the ratio of bank and integrated roll rate, as a share: as for pitch."""
_FORCE_WIDTH = 0.3
"""Standard deviation of the side force's scale by a measured sideslip, as a share. The side force is a small
part of the sideslip's rate, so that a vane's own scale counts several times."""
_USUAL_IN_G, _SPREAD = 2.0, 0.8
"""Side force of one radian of sideslip over the weight, |C_Yβ|/C_L: its usual value, and the standard
deviation of its logarithm. Four aircraft on record have 0.7 to 4.9."""
_DIRECTION = {
    "p": "the right wing goes down", "bank": "the right wing is down", "r": "the nose goes right",
    "a_y": "the force points right", "beta": "the wind comes from the right",
}  # fmt: skip
"""Channel to its positive direction."""


def examine_side(channels: Mapping[str, Channel], earlier: Evidence | None = None) -> Examined:
    """Examine the instruments of roll and yaw.

    Parameters
    ----------
    channels
        Channel name to its samples.
    earlier
        Pooled evidence of earlier records of the same instruments.
    """
    work = Work(dict(channels), earlier or {})
    if _bank_and_rate(work) and hold_force_unit(work):
        hold_clocks(work, "p", "bank")
        told = work.learn(sideslip_against_motion(work.channels))
        if _signs(work, "beta", told, 1.0):
            told = work.learn(force_against_motion(work.channels))
            if _signs(work, "a_y", told, -1.0):
                _side_force_unit(work, told)
    return Examined(work.channels, work.evidence, tuple(work.findings))


def _bank_and_rate(work: Work) -> bool:
    """Hold the roll rate against the bank; return whether sense and unit agree."""
    known = work.learn(rate_against_bank(work.channels)).get("bank_scale")
    if known is None or not work.has("p", "bank"):
        return True
    weighed = weigh(known, {REVERSED: -1.0, "p in deg/s": pi / 180.0, "bank in deg": 180.0 / pi}, _GYRO_WIDTH)
    if not weighed.contradicts:
        return True
    told = f"the bank moves {with_error(known)} times as far as the roll rate says"
    if weighed.best == REVERSED:
        _turned(work, "p", known, told)
    elif weighed.best == ANY:
        work.contradict(
            "p", "scale", 1.0, 1.0 / known.value if known.value else 0.0, known, told,
            "check scale and unit of the roll rate",
        )  # fmt: skip
    else:
        channel, _, unit = weighed.best.partition(" in ")
        stated = {"p": "rad/s", "bank": "rad"}[channel]
        work.contradict(
            channel, "unit", stated, unit, known, f"{PLAIN[channel]} is in {unit}: {told}",
            f"send {PLAIN[channel]} in {stated}",
        )  # fmt: skip
    return False


def _signs(work: Work, name: str, told: Evidence, sense: float) -> bool:
    """Hold the signs of both parts of the sideslip in a channel against ``sense``; return whether no sign
    contradicts.

    A channel that is reversed turns both. A yaw rate or a bank that is reversed turns its own part.
    """
    parts = [told.get(f"{name}_by_{part}") for part in ("weight", "turn")]
    both = told.get(f"{name}_by_motion")
    wrong = [part is not None and _resolved(part) and part.value * sense < 0.0 for part in (*parts, both)]
    right = [part is not None and _resolved(part) and part.value * sense > 0.0 for part in parts]
    if (wrong[2] and not any(right)) or all(wrong[:2]):
        culprit = name
    elif wrong[0] and right[1]:
        culprit = "bank"
    elif wrong[1] and right[0]:
        culprit = "r"
    else:
        return True
    weight, turn = parts
    assert weight is not None
    assert turn is not None
    law = "the side force opposes the sideslip" if name == "a_y" else "the sideslip follows bank and turn"
    values = f"{with_error(weight)} and {with_error(turn)}"
    measured = turn if culprit == "r" else weight
    _turned(work, culprit, measured, f"{law}, with {values} of the parts by bank and by turn")
    return False


def _resolved(measured: Measured) -> bool:
    return abs(measured.value) > SIGMAS * measured.std


def _turned(work: Work, channel: str, measured: Measured, told: str) -> None:
    work.contradict(
        channel, "sign", "right", "left", measured, f"{PLAIN[channel]} has the wrong sign: {told}",
        f"check the sign of {PLAIN[channel]} ({work.channels[channel].source}), positive where "
        f"{_DIRECTION[channel]}",
    )  # fmt: skip


def _side_force_unit(work: Work, told: Evidence) -> None:
    """Hold the unit of the side force against a measured sideslip, or against the usual side force."""
    if not work.has("a_y"):
        return
    source = work.channels["a_y"].source
    stated = stated_force_unit(source)
    factors = {unit: size / FORCE_UNITS_M_S2[stated] for unit, size in FORCE_UNITS_M_S2.items()}
    by_vane, in_g = told.get("beta_by_force"), told.get("a_y_in_g")
    if by_vane is not None and _resolved(by_vane):
        others = {unit: factor for unit, factor in factors.items() if unit != stated}
        weighed = weigh(by_vane, others, _FORCE_WIDTH)
        if weighed.contradicts and weighed.best != AS_STATED:
            unit = "an unknown unit" if weighed.best == ANY else weighed.best
            _in_unit(work, stated, unit, by_vane, "the sideslip needs it times")
    elif in_g is not None and _resolved(in_g):
        likely = {unit: _likelihood(abs(in_g.value) * factor) for unit, factor in factors.items()}
        best = max(likely, key=lambda unit: likely[unit])
        if likely[stated] < EXCLUDED * sum(likely.values()):
            _in_unit(work, stated, best, in_g, "its part of the weight in a radian of sideslip is")


def _likelihood(in_g: float) -> float:
    """Return the density of a side force of one radian of sideslip, over the weight, up to a constant."""
    return exp(-0.5 * (log(in_g / _USUAL_IN_G) / _SPREAD) ** 2)


def _in_unit(work: Work, stated: str, unit: str, measured: Measured, told: str) -> None:
    work.contradict(
        "a_y", "unit", stated, unit, measured,
        f"the side force is in {unit}, not in {stated}: {told} {with_error(measured)}",
        f"send {work.channels['a_y'].source} in {stated}",
    )  # fmt: skip
