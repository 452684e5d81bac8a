"""Limits of telemetry from defects of instruments and clocks, and from the pace of messages."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Elevator
from advisor.decision.envelope import needed_hz
from advisor.decision.first_unit import frequency
from advisor.doctor.examination import ElevatorFound, Limit
from advisor.doctor.expectation import Assumed, ExpectedErrors, expect
from advisor.doctor.survey import Arrival, Clocks
from advisor.flight.signals.track import ChannelStatus
from advisor.flight.signals.trust import Distrust
from advisor.flight.stream.suitability import SLOWEST_HZ
from advisor.flight.vehicle.surfaces import joined_numbers
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.mends import GOOD_HZ, Carrier
from advisor.words.problems import Problem
from advisor.words.quantities import distinct_texts

COARSE_DEG = 0.5
"""Resolution of the command, deg, above which small steps are not reproduced as steps."""
LOSSY_PERCENT = 5.0
REPEATED_PERCENT = 1.0
"""Fraction of repeated packets, %, above which a second network path is assumed. A network with one path
repeats only single packets.
"""
DRIFTING_PERCENT = 1.0
SIMULATED_PERCENT = 10.0
"""Clock drift, %, above which the clock must be a simulator's. The error of a crystal is .01 %, of the worst
RC oscillator 5 %.
"""
_MOTION = ("ATTITUDE", "RAW_IMU", "SCALED_IMU", "HIGHRES_IMU")
"""Messages whose values change with every sample of a sensor in flight."""
_MOSTLY_NEW = 0.7
"""Least ratio of the rate of new values to the rate of messages, above which values are not repeated, as in
``renewal.py``. Messages that come twice have 0.5, sound messages 0.95 to 1.
"""
STRAYED_SHARE = 0.01
"""Largest fraction of a message's stamps that may fit neither clock. Around a reboot a few stamps always fit
neither clock."""

_A_VANE = "fit a vane that sends {} (alpha.source: named_value:NAME)"


def alpha_limits(alpha: ChannelStatus, vehicle: Vehicle) -> list[Limit]:
    """Return the limits of an angle of attack that is not measured by a vane."""
    if alpha.provenance != "derived":
        return []
    vane = _A_VANE.format(vehicle.mends.called("NAMED_VALUE_FLOAT"))
    if alpha.source.startswith("AOA_SSA"):
        name = vehicle.mends.called("AOA_SSA")
        text = f"{name} is the autopilot's own estimate and no vane, so it is late and shows no gusts"
        return [Limit("alpha_derived", text, f"fly in calm air, or {vane}")]
    text = (
        "The angle of attack is derived from pitch, climb rate and air speed: it is late and shows no gusts"
    )
    better = ""
    if vehicle.autopilot == "ardupilot":
        over_link = f"ask for AOA_SSA over MAVLink 2: {vehicle.mends.faster('AOA_SSA')}"
        better = over_link if vehicle.carrier == "telemetry" else vehicle.mends.present(["AOA_SSA"])
        better += "; or "
    return [Limit("alpha_derived", text, better + vane)]


def elevator_limits(wired: ElevatorFound, elevator: Elevator) -> list[Limit]:
    """Return the defects of the elevator's calibration, resolution and servo."""
    limits = [
        Limit(d.code, d.text.rstrip("."), f"{d.fix[:1].lower()}{d.fix[1:].rstrip('.')}") for d in wired.doubts
    ]
    if not wired.calibrated:
        given = "whose pulses are assumed" if wired.doubts else "as the parameters state"
        listed = joined_numbers(wired.outputs)
        several = len(wired.outputs) > 1
        outputs = f"Outputs {listed} are" if several else f"Output {listed} is"
        key = "elevator.outputs, each with its calibration," if several else "elevator.calibration"
        limits.append(
            Limit(
                "calibration",
                f"{outputs} not calibrated: full travel, {given}, is assumed to be 25 deg, so the scale of "
                f"Z_δe and M_δe is assumed",
                f"measure the deflection at three pulse widths and give {key} in the aircraft file",
            )
        )
    if wired.resolution_deg > COARSE_DEG:
        shown, most = distinct_texts(wired.resolution_deg, COARSE_DEG, 2)
        limits.append(
            Limit(
                "resolution",
                f"One microsecond of the elevator's pulse is {shown} deg (limit {most})",
                "check the calibration in the aircraft file; use more of the servo's travel",
            )
        )
    if elevator.lag_s is None:
        limits.append(
            Limit(
                "servo_unknown",
                "The servo's lag and delay are not given: the fit estimates the lag, and the intervals of "
                "M_α and M_δe are wider",
                "measure the servo on the ground and give elevator.lag_s and elevator.delay_s",
            )
        )
    return limits


def distrust_limits(distrusts: Iterable[Distrust]) -> list[Limit]:
    """Return a defect for each channel whose values cannot be right. Another function reports a frozen pitch
    rate.
    """
    wrong = {d.channel: d for d in distrusts if not (d.stops and d.code == "frozen")}
    return [Limit(d.code, d.sentence, d.fix, stops=d.stops) for d in wrong.values()]


def repeat_limits(arrivals: Iterable[Arrival]) -> list[Limit]:
    """Return a defect if the motion's messages repeat old values under new stamps."""
    return [
        Limit(
            "repeats",
            f"{a.name} arrives at {a.rate_hz:.0f} Hz, but its values change at {a.renewed_hz:.0f} Hz "
            "only; a repeated value counts once",
            f"record one stream of {a.name} only: one radio, one rate request, one output of the router",
        )
        for a in arrivals
        if a.name in _MOTION and a.renewed_hz < _MOSTLY_NEW * a.rate_hz
    ]


def clock_limits(clocks: Clocks) -> list[Limit]:
    """Return defects of clocks: reboots, stamps of another clock, drift."""
    limits = []
    if clocks.boots > 1:
        limits.append(
            Limit(
                "reboot",
                f"The vehicle was switched on {clocks.boots} times within the record",
                "each power-on counts as a separate flight; check the power supply if this was not intended",
            )
        )
    for name, share in clocks.strayed.items():
        if share <= STRAYED_SHARE:
            continue
        limits.append(
            Limit(
                "clock",
                f"{100.0 * share:.1f} % of the stamps of {name} lie more than 5 s off the clock of ATTITUDE",
                f"check that only one vehicle sends {name} under this system id",
            )
        )
    if abs(clocks.drift_percent) > DRIFTING_PERCENT and not _is_simulated(clocks):
        limits.append(
            Limit(
                "clock_drift",
                f"The vehicle's clock runs {clocks.drift_percent:+.1f} % against the host's",
                "compare both clocks with GPS time; a wrong clock of the vehicle makes every rate wrong by "
                "this percentage",
            )
        )
    return limits


def clock_notes(clocks: Clocks) -> list[str]:
    """Return a sentence on the clock of a simulator that runs faster or slower than the host's."""
    if not _is_simulated(clocks):
        return []
    times = 1.0 + 0.01 * clocks.drift_percent
    runs = f"The vehicle's clock runs {times:.2g} times as fast as the host's, so it is a simulator's clock"
    return [f"{runs}: rates refer to the vehicle's clock."]


def _is_simulated(clocks: Clocks) -> bool:
    return abs(clocks.drift_percent) > SIMULATED_PERCENT


def sender_limits(two_senders: Problem | None) -> list[Limit]:
    """Return a defect if two senders share one system id. The flight stream has the same rule."""
    if two_senders is None:
        return []
    return [Limit(two_senders.code, two_senders.text.rstrip("."), two_senders.fix.rstrip("."))]


def company_limits(other_systems: Collection[int]) -> list[Limit]:
    """Return a defect for other vehicles on the link, if the user selected none."""
    if not other_systems:
        return []
    others = ", ".join(map(str, sorted(other_systems)))
    return [
        Limit(
            "several_vehicles",
            f"Other vehicles are heard too (system {others}); the examination uses the first vehicle that "
            f"was heard",
            f"choose one, e.g. --target-system {min(other_systems)}",
        )
    ]


def loss_limits(lost_percent: float | None) -> list[Limit]:
    """Return a defect for packets that a live link lost; empty if packets were not counted."""
    if lost_percent is None or lost_percent <= LOSSY_PERCENT:
        return []
    shown, most = distinct_texts(lost_percent, LOSSY_PERCENT, 1)
    return [
        Limit(
            "loss",
            f"{shown} % of the packets are lost (limit {most} %)",
            "lower the rates of messages that nobody needs, or check the radio link",
        )
    ]


def path_limits(repeated_percent: float, after_s: float) -> list[Limit]:
    """Return a defect for a second network path that repeats packets. The advisor uses a repeated packet only
    once.
    """
    if repeated_percent <= REPEATED_PERCENT:
        return []
    return [
        Limit(
            "second_path",
            f"a second path repeats {repeated_percent:.0f} % of the packets, {after_s:.1f} s late",
            "listen to one path only, with one radio, one output of the router and one --master; the "
            "earlier one",
        )
    ]


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
