"""Rates of channels relative to the aircraft's natural frequency, and the cost of slow channels."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.decision.envelope import needed_hz
from advisor.decision.first_unit import frequency
from advisor.doctor.examination import Limit
from advisor.doctor.expectation import Assumed, ExpectedErrors, expect
from advisor.doctor.survey import Arrival
from advisor.flight.stream.suitability import SLOWEST_HZ
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.digits import distinct_texts
from advisor.words.mends import GOOD_HZ, Carrier

ENOUGH_PER_PERIOD = 20.0
"""Number of samples in one natural period above which faster telemetry hardly improves the errors."""
GAP_INTERVALS = 3.0
"""Shortest interval that counts as a gap, in multiples of the message's usual interval."""
FALLEN = 0.6
"""Fraction of the usual rate below which a message is considered interrupted."""
EVEN = 0.9
"""Ratio of the mean rate to the rate of the best ten seconds above which only the mean rate is stated. Jitter
costs less.
"""

_DROPPED = (
    "the autopilot could not write all records: log fewer or use a faster card; a manoeuvre with such a "
    "gap is flown again"
)
_PAUSED = "the table has a pause; a manoeuvre with such a gap is flown again"
_FELL = (
    "keep other ground stations from setting stream rates (MAVProxy --streamrate=-1; -1 in Mission Planner's "
    "telemetry rates) and check the radio link"
)
_LOST = "check the radio link and its antennas; a manoeuvre with such a gap is flown again"
_PLAIN = {"elevator": "elevator command", "q": "pitch rate", "alpha": "angle of attack"}


@dataclass(frozen=True, slots=True)
class Paced:
    """One channel, with the message that determines its rate."""

    channel: str
    message: str
    rate_hz: float
    """Samples of the channel per second over the whole record."""
    renewed_hz: float
    """New values of the channel per second, at most ``rate_hz``."""
    best_hz: float = 0.0
    """Samples of the channel per second over its best ten seconds."""

    @property
    def arrives(self) -> str:
        """Mean rate in words. If the rate falls, the rate of the best ten seconds follows."""
        mean = f"{self.rate_hz:.1f} Hz"
        if self.rate_hz > EVEN * self.best_hz:
            return mean
        return f"{mean} on average ({self.best_hz:.1f} Hz over its best ten seconds)"


def rate_limits(
    paced: Mapping[str, Paced], assumed: Assumed, vehicle: Vehicle, airspeed_m_s: float | None
) -> list[Limit]:
    """Return a defect for every channel that is too slow for this aircraft.

    Parameters
    ----------
    paced
        Rates of elevator and q, and of alpha and a_z where these are measured. A low rate
        of alpha does not prevent identification if a_z and air speed are measured.
    """
    period_s = 2.0 * np.pi / frequency(assumed.model)
    fewest_hz = max(SLOWEST_HZ, needed_hz(period_s))
    enough_hz = max(SLOWEST_HZ, ENOUGH_PER_PERIOD / period_s)
    good = {name: max(float(GOOD_HZ), channel.renewed_hz) for name, channel in paced.items()}
    best = expect(assumed, good, airspeed_m_s)
    limits = []
    stands_in = "a_z" in paced and airspeed_m_s is not None
    for name in ("elevator", "q", "alpha"):
        channel = paced.get(name)
        if channel is None or channel.renewed_hz >= enough_hz:
            continue
        alone = expect(assumed, {**good, name: channel.renewed_hz}, airspeed_m_s)
        repeats = channel.rate_hz >= enough_hz
        message = vehicle.mends.called(channel.message)
        arrives = f"{message} arrives at {channel.arrives}"
        if repeats:
            arrives += f" but changes only at {channel.renewed_hz:.1f} Hz"
        limits.append(
            Limit(
                "renewal" if repeats else "rate",
                f"{arrives}: {_samples(channel.renewed_hz, fewest_hz, enough_hz, _PLAIN[name], period_s)}",
                _staircase(message, vehicle) if repeats else vehicle.mends.faster(channel.message),
                stops=channel.renewed_hz < fewest_hz and not (name == "alpha" and stands_in),
                std_ratio=_ratio(alone, best),
            )
        )
    return limits


def _samples(hz: float, fewest_hz: float, enough_hz: float, plain: str, period_s: float) -> str:
    """Return the number of samples in a natural period as text, with the limits that this number misses."""
    samples, fewest, enough = hz * period_s, fewest_hz * period_s, enough_hz * period_s
    if hz < fewest_hz:
        shown, least = distinct_texts(samples, fewest, 1)
        limits = f"at least {least}, better {enough:.0f}"
    else:
        shown, better = distinct_texts(samples, enough, 1)
        limits = f"at least {fewest:.0f}, better {better}"
    return f"{shown} samples of {plain} in a natural period of {period_s:.2f} s ({limits})"


def steadiness_limits(
    arrivals: Mapping[str, Arrival], needed: set[str], period_s: float, carrier: Carrier
) -> list[Limit]:
    """Return a defect for each message that arrived with interruptions."""
    limits = []
    for name in sorted(needed & arrivals.keys()):
        arrival = arrivals[name]
        if arrival.lowest_hz < FALLEN * arrival.rate_hz:
            code, mend = "rate_fell", _FELL
            at_worst = f"at {arrival.lowest_hz:.1f} Hz over its worst five seconds"
            text = f"{name} came at {arrival.rate_hz:.1f} Hz, but {at_worst}"
        elif arrival.largest_gap_s > max(0.5 * period_s, GAP_INTERVALS / arrival.rate_hz):
            code, mend = "gap", _LOST
            text = f"{name} was missing for {arrival.largest_gap_s:.2f} s at its worst"
        else:
            continue
        fix = {"telemetry": mend, "table": _PAUSED}.get(carrier, _DROPPED)
        limits.append(Limit(code, text, fix))
    return limits


def cost_of_missing(
    channel: str, paced: Mapping[str, Paced], assumed: Assumed, airspeed_m_s: float | None
) -> Mapping[str, float]:
    """Return the cost of a missing a_z, or of a missing air speed that makes a_z useless."""
    rates = {name: p.renewed_hz for name, p in paced.items() if name != channel}
    with_it = expect(assumed, {**rates, channel: float(GOOD_HZ)}, airspeed_m_s or 25.0)
    return _ratio(expect(assumed, rates, airspeed_m_s), with_it)


def _staircase(message: str, vehicle: Vehicle) -> str:
    return (
        f"no setting helps: the sender itself updates {message} at this pace; a vane that sends "
        f"{vehicle.mends.called('NAMED_VALUE_FLOAT')} (alpha.source: named_value:NAME) can be faster"
    )


def _ratio(now: ExpectedErrors, mended: ExpectedErrors) -> dict[str, float]:
    ratios = {name: std / mended.std[name] for name, std in now.std.items()}
    return {name: ratio for name, ratio in ratios.items() if np.isfinite(ratio)}
