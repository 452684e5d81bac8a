"""Arrival of every message of the vehicle, counted on the vehicle's clock."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.channels import stamps
from advisor.flight.signals.clocks import Attitudes, BootClock
from advisor.flight.signals.messages import Columns, cut
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.process.arrays import FloatArray
from advisor.words.quantities import stretch

# The field whose change shows that a message brings a new value.
_TELLING = {
    "ATTITUDE": ("pitchspeed",),
    "ATTITUDE_QUATERNION": ("pitchspeed",),
    "AOA_SSA": ("AOA",),
    "VFR_HUD": ("airspeed",),
    "RAW_IMU": ("xacc", "yacc", "zacc"),
    "SCALED_IMU": ("xacc", "yacc", "zacc"),
    "SCALED_IMU2": ("xacc", "yacc", "zacc"),
    "SCALED_IMU3": ("xacc", "yacc", "zacc"),
    "HIGHRES_IMU": ("xacc", "yacc", "zacc"),
    "GLOBAL_POSITION_INT": ("relative_alt", "vx", "vy", "vz"),
    "SERVO_OUTPUT_RAW": tuple(f"servo{n}_raw" for n in range(1, 9)),
    "ACTUATOR_OUTPUT_STATUS": ("actuator",),
    "NAMED_VALUE_FLOAT": ("value",),
}
_EVENTS = frozenset({"PARAM_VALUE", "STATUSTEXT", "COMMAND_ACK", "COMMAND_LONG", "AUTOPILOT_VERSION"})
"""Messages that the vehicle sends on events, so that they have no rate."""
_SILENCE = 5.0
"""Multiple of the typical interval above which an interval counts as a gap of the link."""
_LIVELY_S = 0.5
"""Time, s, after which an unchanged value counts as constant. A constant value says nothing about how often
new values come.
"""
_WINDOW_S = 5.0
"""Length of the window, s, over which the lowest rate is counted."""


@dataclass(frozen=True, slots=True)
class Arrival:
    """Statistics of one message's arrival."""

    name: str
    count: int
    rate_hz: float
    """Rate of the message, 1/s, from the first to the last one. NaN with fewer than three messages."""
    jitter_ms: float
    """Standard deviation of the intervals between stamps, without gaps."""
    largest_gap_s: float
    """Longest time between two messages within one boot, without pauses of the log."""
    renewed_hz: float
    """Rate of new values, Hz, while the values change. NaN if no field of the message shows changes."""
    lowest_hz: float
    """Rate of the slowest five seconds within the stretch in which the message came."""


@dataclass(frozen=True, slots=True)
class Clocks:
    """Consistency of the messages' time stamps."""

    boots: int
    """Number of the vehicle's power-ons within the record."""
    drift_percent: float
    """Excess of the vehicle clock's speed over the host clock's, in percent. NaN if the drift is unknown."""
    arrival_jitter_ms: float
    """Standard deviation, ms, of the arrival times relative to the vehicle's clock. The link causes this
    jitter.
    """
    strayed: Mapping[str, float]
    """Fraction of stamps that do not fit the vehicle's clock, by the message's name."""


@dataclass(slots=True)
class _Sender:
    """Stamps of the messages of one type from one system, and for each message whether its value is new."""

    t: list[FloatArray] = field(default_factory=list)
    boot: list[NDArray[np.int64]] = field(default_factory=list)
    news: list[NDArray[np.bool_]] = field(default_factory=list)
    strayed: int = 0
    last: FloatArray | None = None

    def news_in(self, values: FloatArray) -> NDArray[np.bool_]:
        """Return whether each row differs from the row before, shape (n,)."""
        if len(values) == 0:
            return np.zeros(0, dtype=bool)
        before = values[:1] if self.last is None else self.last
        self.last = values[-1:]
        changed: NDArray[np.bool_] = np.any(values != np.concatenate((before, values[:-1])), axis=1)
        return changed


@dataclass(frozen=True, slots=True)
class _Pause:
    """A time interval of one boot in which the autopilot wrote nothing."""

    boot: int
    start_s: float
    end_s: float


class Survey:
    """Counts every message of one vehicle.

    The stamps of ATTITUDE are the clock, as in all parts of the advisor. A message without a stamp takes the
    stamp of the ATTITUDE before it. A stream without ATTITUDE is counted by its times of arrival.
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self._who = (vehicle.system, vehicle.component)
        self._carrier = vehicle.carrier
        self._attitudes = Attitudes()
        self._clock = BootClock()
        self._master_s = np.nan
        self._senders: dict[str, _Sender] = {}
        self._clock_pairs: list[FloatArray] = []

    def feed(self, columns: Sequence[Columns]) -> None:
        """Take messages in order of arrival."""
        mine = [part for part in columns if (part.system, part.component) == self._who or self._helps(part)]
        attitude = next((part for part in self._attitudes.of(mine) if part.name == "ATTITUDE"), None)
        orders, clock, boots = self._advance(attitude)
        for part in mine:
            if part.name in _EVENTS:
                continue
            at = np.searchsorted(orders, part.order, side="right") - 1
            for name, rows in _banks(part):
                self._take(name, cut(part, rows), clock[at][rows], boots[at][rows])
        self._master_s = float(clock[-1])

    def _helps(self, part: Columns) -> bool:
        """Return whether another component of the vehicle sends the vehicle's angle of attack."""
        return part.system == self._who[0] and part.name == "AOA_SSA"

    def _advance(self, attitude: Columns | None) -> tuple[NDArray[np.int64], FloatArray, NDArray[np.int64]]:
        """Return the master clock after each ATTITUDE of this batch, and before the first."""
        order, clock, boots = [-1], [self._master_s], [self._clock.boot]
        if attitude is not None:
            ticks = self._clock.advance(np.asarray(attitude.fields["time_boot_ms"], dtype=np.int64))
            believed = np.isfinite(ticks.t)
            order += attitude.order[believed].tolist()
            clock += ticks.t[believed].tolist()
            boots += ticks.boot[believed].tolist()
            pairs = np.column_stack([attitude.arrival_s, ticks.t, ticks.boot])[believed]
            self._clock_pairs.append(pairs)
        return np.array(order), np.array(clock), np.array(boots)

    def _take(self, name: str, part: Columns, master_s: FloatArray, boot: NDArray[np.int64]) -> None:
        sender = self._senders.setdefault(name, _Sender())
        # A heartbeat before the first ATTITUDE has no vehicle time, and is counted by arrival only.
        timed = np.isfinite(master_s)
        own_clock = part.component != self._who[1]
        t = np.where(timed, master_s if own_clock else stamps(part, master_s), np.nan)
        sender.strayed += int(np.count_nonzero(timed & ~np.isfinite(t)))
        telling = _telling(part)
        # A dataflash log keeps angles and rates apart: a row without the telling field is no message.
        filled = ~np.all(np.isnan(telling), axis=1) if telling.shape[1] else np.ones(len(part), dtype=bool)
        sender.t.append(t[filled])
        sender.boot.append(boot[filled])
        sender.news.append(sender.news_in(telling[filled]))

    @property
    def clocks(self) -> Clocks:
        """Consistency of the stamps with each other."""
        pairs = np.concatenate(self._clock_pairs) if self._clock_pairs else np.empty((0, 3))
        strayed = {
            name: sender.strayed / sum(map(len, sender.t))
            for name, sender in self._senders.items()
            if sender.strayed and any(map(len, sender.t))
        }
        drift, jitter = _against_the_host(pairs)
        return Clocks(self._clock.boot + 1, drift, jitter, strayed)

    @property
    def arrivals(self) -> list[Arrival]:
        """Every message that arrived, the most frequent first."""
        pauses = self._pauses()
        arrivals = [
            _arrival(name, sender, pauses)
            for name, sender in self._senders.items()
            if any(map(len, sender.t))
        ]
        return sorted(arrivals, key=lambda arrival: (-arrival.count, arrival.name))

    @property
    def pauses(self) -> list[str]:
        """Sentences on the time intervals in which the autopilot wrote nothing into its own log."""
        because = " (LOG_DISARMED 0)" if self._carrier == "dataflash" else ""
        return [
            f"The autopilot logged nothing from {stretch(p.start_s, p.end_s)} since power-on, as it may "
            f"while disarmed{because}: no link was lost."
            for p in self._pauses()
        ]

    def _pauses(self) -> list[_Pause]:
        """Return the time intervals without any message. A link has none, because such intervals are its
        faults.
        """
        if self._carrier == "telemetry" or not self._clock_pairs:
            return []
        _, t, boot = np.concatenate(self._clock_pairs).T
        others = [
            np.column_stack([np.concatenate(s.t), np.concatenate(s.boot)]) for s in self._senders.values()
        ]
        every = np.concatenate([np.column_stack([t, boot]), *others])
        every = every[np.all(np.isfinite(every), axis=1)]
        every = every[np.lexsort((every[:, 0], every[:, 1]))]
        silent = (np.diff(every[:, 0]) > _WINDOW_S) & (np.diff(every[:, 1]) == 0)
        return [
            _Pause(int(every[row, 1]), float(every[row, 0]), float(every[row + 1, 0]))
            for row in np.flatnonzero(silent)
        ]


def bank_name(port: int) -> str:
    """Return the survey's name for the SERVO_OUTPUT_RAW of one bank of outputs, 0 for the first."""
    return "SERVO_OUTPUT_RAW" if port == 0 else f"SERVO_OUTPUT_RAW port {port}"


def _banks(part: Columns) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Yield messages that are counted together; two banks of outputs make one sample."""
    if part.name != "SERVO_OUTPUT_RAW":
        yield part.name, np.ones(len(part), dtype=bool)
        return
    ports = part.fields["port"]
    for port in np.unique(ports).tolist():
        yield bank_name(port), ports == port


def _telling(part: Columns) -> FloatArray:
    """Return the fields whose changes show that a value is new, shape (n, fields)."""
    names = [name for name in _TELLING.get(part.name, ()) if name in part.fields]
    columns = [np.asarray(part.fields[name], dtype=np.float64).reshape(len(part), -1) for name in names]
    return np.column_stack(columns) if columns else np.empty((len(part), 0))


def _arrival(name: str, sender: _Sender, pauses: Sequence[_Pause]) -> Arrival:
    t, boot, news = np.concatenate(sender.t), np.concatenate(sender.boot), np.concatenate(sender.news)
    # After a pause messages restart, as after a boot.
    boot = boot + sum(((boot > p.boot) | (boot == p.boot) & (t > p.start_s)).astype(np.int64) for p in pauses)
    order = np.lexsort((t, boot))
    t, boot, news = t[order], boot[order], news[order]
    fresh = np.isfinite(t) & np.concatenate([[True], (np.diff(t) != 0.0) | (np.diff(boot) != 0)])
    steps = _intervals(t[fresh], boot[fresh])
    if len(steps) < 2:
        return Arrival(name, len(t), np.nan, np.nan, np.nan, np.nan, np.nan)
    pace = steps[steps <= _SILENCE * _typical(steps)]
    renewals = _intervals(t[fresh & news], boot[fresh & news])
    renewals = renewals[renewals <= max(_LIVELY_S, 3.0 * float(np.median(steps)))]
    return Arrival(
        name=name,
        count=len(t),
        rate_hz=float(1.0 / np.mean(pace)),
        jitter_ms=float(1e3 * np.std(pace)),
        largest_gap_s=float(np.max(steps)),
        renewed_hz=float(1.0 / np.mean(renewals)) if len(renewals) > 1 else np.nan,
        lowest_hz=_lowest_rate(t[fresh], boot[fresh]),
    )


def _intervals(t: FloatArray, boot: NDArray[np.int64]) -> FloatArray:
    same = np.diff(boot) == 0
    intervals: FloatArray = np.diff(t)[same]
    return intervals


def _lowest_rate(t: FloatArray, boot: NDArray[np.int64]) -> float:
    """Return the lowest rate, 1/s, over windows of ``_WINDOW_S`` that begin with a message."""
    rates = []
    for n in np.unique(boot):
        mine = t[boot == n]
        whole = mine[mine <= mine[-1] - _WINDOW_S]
        counts = np.searchsorted(mine, whole + _WINDOW_S) - np.arange(len(whole))
        rates += (counts / _WINDOW_S).tolist()
    return float(min(rates)) if rates else np.nan


def _typical(steps: FloatArray) -> float:
    """Return the interval, s, below which the intervals make up half of the time. Silences over ``_WINDOW_S``
    are left out.
    """
    ordered = np.sort(steps[steps <= _WINDOW_S])
    if len(ordered) == 0:
        return float(np.median(steps))
    return float(ordered[np.searchsorted(np.cumsum(ordered), 0.5 * np.sum(ordered))])


def _against_the_host(pairs: FloatArray) -> tuple[float, float]:
    """Return drift (percent) and jitter (ms) of arrival against vehicle time, over the longest boot."""
    if len(pairs) == 0:
        return np.nan, np.nan
    boots, counts = np.unique(pairs[:, 2], return_counts=True)
    arrival, vehicle = pairs[pairs[:, 2] == boots[np.argmax(counts)], :2].T
    if len(vehicle) < 10 or np.ptp(arrival) <= 0.0 or np.ptp(vehicle) <= 0.0:
        return np.nan, np.nan
    slope, offset = np.polyfit(vehicle - vehicle[0], arrival - arrival[0], 1)
    residual = arrival - arrival[0] - slope * (vehicle - vehicle[0]) - offset
    return float(100.0 * (1.0 / slope - 1.0)), float(1e3 * np.std(residual))
