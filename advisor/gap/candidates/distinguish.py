"""Measurements that would show an effect, or distinguish it from a cause that looks like it."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.gap.effects import EFFECTS
from advisor.gap.kit.effect import Need
from advisor.gap.records.flights import PreparedManeuvers


def way_to_distinguish(effect: str, other: str) -> str:
    """Return the measurement that would distinguish two effects; empty when none is known."""
    return EFFECTS[effect].distinguished_by.get(other) or EFFECTS[other].distinguished_by.get(effect, "")


def imitations(name: str, channels: Sequence[str]) -> list[tuple[str, str]]:
    """Return the causes outside the catalogue that look like an effect, each with the measurement that
    distinguishes it."""
    effect = EFFECTS[name]
    alike = [] if effect.imitated_by is None else [effect.imitated_by]
    if effect.imitated_without is not None and effect.imitated_without[0] not in channels:
        alike.append(effect.imitated_without[1:])
    return alike


OTHERWISE = "fly another time unit and another amplitude"
"""Advice if no measurement is known that would distinguish two effects."""
_CHANNELS = {"alpha": "AOA_SSA at 50 Hz", "a_z": "RAW_IMU at 50 Hz", "theta": "ATTITUDE at 50 Hz"}
ONE_IMU = ("the angle of attack is made of the same inertial sensors", "a vane")
"""Reason why an autopilot's own angle of attack cannot show some effects, and the measurement that would."""


def need_of(name: str, flights: PreparedManeuvers) -> Need:
    """Return the reason why these flights cannot show an effect: its channel was not recorded or did not
    vary."""
    effect = EFFECTS[name]
    assert effect.need is not None
    if effect.unrecorded is not None:
        channel, because, add = effect.unrecorded
        if channel not in flights.has:
            return replace(effect.need, because=because, add=add)
    if effect.without_speed is not None and not flights.speed_measured:
        because, add = effect.without_speed
        return replace(effect.need, because=because, add=add)
    return effect.need


def hidden_from(effect: str, flights: PreparedManeuvers) -> tuple[str, str]:
    """Return the reason why other effects imitate an effect completely, and the channel or
    manoeuvre to add.
    """
    if not EFFECTS[effect].of_the_stick:
        need = need_of(effect, flights)
        return need.because, need.add
    missing = [message for channel, message in _CHANNELS.items() if channel not in flights.channels]
    if missing:
        return "these channels do not show it", " and ".join(missing)
    return "these manoeuvres do not show it", f"fly larger steps; {OTHERWISE}"
