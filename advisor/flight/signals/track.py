"""A track: samples of one channel from one source as they arrive, with bounded memory, and the true air
speed.

The equations of motion need the true air speed V. An autopilot's pressure sensor gives the speed that its
pressure would have at sea level: V·√(ρ/ρ_0) with ρ_0 = 1.225 kg/m³. The density ρ comes from the static
pressure, else from the height above mean sea level. A barometer's temperature is not used, because the board
warms the sensor. One simulated autopilot reports 30 °C, with which V would be 3.5 % too large.

The standard atmosphere holds below 11 km (ISO 2533).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.signals.channels import GIVEN_AIRSPEED, TRUE_AIRSPEED
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray, IntArray

MOST = 600
"""Largest number of stretches, about the number of dots across a terminal. With more stretches, neighbours
are joined."""
_FIRST_S = 0.25
"""Initial length of a stretch, s: half a step of the quickest input."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A channel over time, as its smallest and largest values in stretches of equal length."""

    t: FloatArray
    """Shape (n,): middle of each stretch with samples, s since boot."""
    low: FloatArray
    """Shape (n,): smallest value in each stretch, SI."""
    high: FloatArray
    """Shape (n,): largest value in each stretch, SI."""


class Extremes:
    """Smallest and largest values of one channel, collected from batches of any size."""

    def __init__(self) -> None:
        self._begin_s = np.nan
        self._length_s = _FIRST_S
        self._low = np.full(MOST, np.inf)
        self._high = np.full(MOST, -np.inf)

    def add(self, t: FloatArray, y: FloatArray) -> None:
        """Take stamps and values of samples, shape (n,) each. Samples before the first stretch are
        dropped."""
        if np.isnan(self._begin_s):
            self._begin_s = float(t[0])
        late = t >= self._begin_s
        t, y = t[late], y[late]
        if len(t) == 0:
            return
        since_s = t - self._begin_s
        while float(np.max(since_s)) / self._length_s >= MOST:
            self._halve()
        places = (since_s / self._length_s).astype(np.intp)
        np.minimum.at(self._low, places, y)
        np.maximum.at(self._high, places, y)

    @property
    def course(self) -> Course:
        """Smallest and largest values of the channel so far."""
        filled = np.flatnonzero(self._high >= self._low)
        t = np.asarray(self._begin_s + (filled + 0.5) * self._length_s, dtype=np.float64)
        return Course(t, self._low[filled], self._high[filled])

    def _halve(self) -> None:
        """Join neighbouring stretches, so that each is twice as long."""
        half = MOST // 2
        low, high = self._low.reshape(half, 2).min(axis=1), self._high.reshape(half, 2).max(axis=1)
        self._low, self._high = np.full(MOST, np.inf), np.full(MOST, -np.inf)
        self._low[:half], self._high[:half] = low, high
        self._length_s *= 2.0


@dataclass(frozen=True, slots=True)
class PowerOn:
    """All channels that one vehicle sent from one power-on to the next.

    A stream keeps power-ons only on request, because their memory grows with the flight.
    """

    boot: int
    """Number of the power-on in its log, 0 for the first."""
    channels: Mapping[str, Channel]
    """Samples of each channel from its best source, SI, by the channel's name."""
    clock_order: IntArray
    """Shape (n,), rising: arrival index of each message with a stamp of the vehicle's clock."""
    clock_s: FloatArray
    """Shape (n,), never falling: vehicle's clock at each arrival in ``clock_order``, s since boot."""
    modes: tuple[tuple[float, str], ...] = ()
    """Vehicle time of each flight mode change, s since boot (NaN before the first clock stamp), and the
    mode's name."""

    def arrivals(self, start_s: float, end_s: float) -> tuple[int, int]:
        """Return the arrival indices of the clock's first and last stamp with ``start_s <= t <= end_s``.

        Raises
        ------
        ValueError
            The clock has no stamp within this stretch.
        """
        i, j = np.searchsorted(self.clock_s, [start_s, np.nextafter(end_s, np.inf)])
        if i == j:
            raise ValueError("the vehicle's clock shows no time of this stretch")
        return int(self.clock_order[i]), int(self.clock_order[j - 1])


_WINDOW_S = 10.0
"""Length of vehicle time over which samples are counted, s: longer than most manoeuvres."""
_LEAST_S = 5.0
"""Least time between the first and the last sample for a valid rate, s: half of ``_WINDOW_S``."""


class BestRate:
    """Fastest rate of a channel over all ten-second periods since boot.

    A sample is counted if its stamp is newer than all earlier stamps. A packet that arrives twice is counted
    once, and the size of batches makes no difference.
    """

    def __init__(self) -> None:
        self._best_hz = np.nan
        self._window = -1.0
        self._first_s = self._last_s = -np.inf
        self._count = 0

    def add(self, t: FloatArray) -> None:
        """Take stamps, s since boot, shape (n,), in order of arrival."""
        newest = np.maximum.accumulate(np.concatenate(([self._last_s], t)))
        fresh = t[t > newest[:-1]]
        while len(fresh) > 0:
            window = float(fresh[0] // _WINDOW_S)
            end = int(np.searchsorted(fresh, (window + 1.0) * _WINDOW_S))
            stamps, fresh = fresh[:end], fresh[end:]
            if window != self._window:
                self._best_hz = self.rate_hz
                self._window, self._count, self._first_s = window, 0, float(stamps[0])
            self._count += len(stamps)
            self._last_s = float(stamps[-1])

    @property
    def rate_hz(self) -> float:
        """Best rate, samples per second; from the whole time if no period is long enough. NaN with a single
        sample."""
        span_s = self._last_s - self._first_s
        if not (self._count > 1 and span_s > 0.0):
            return self._best_hz
        rate_hz = (self._count - 1) / span_s
        if span_s >= _LEAST_S:
            return float(np.fmax(rate_hz, self._best_hz))
        return rate_hz if np.isnan(self._best_hz) else self._best_hz


@dataclass(frozen=True, slots=True)
class ChannelStatus:
    """Arrival status of one channel: rate, gap and range."""

    source: str
    provenance: str
    rate_hz: float
    """Samples per second over the newest ten seconds of the channel."""
    largest_gap_s: float
    """Longest time between two stamps since boot."""
    last_s: float
    """Vehicle time of the newest sample."""
    best_hz: float = np.nan
    """Samples per second over the best ten seconds since boot."""
    lowest: float = np.nan
    """Smallest value since boot, SI."""
    highest: float = np.nan
    """Largest value since boot, SI."""
    newest: float = np.nan
    """Value of the newest sample, SI."""

    def at_best(self, earlier: "ChannelStatus | None" = None) -> "ChannelStatus":
        """Return the status with the best rate and the range of this source over all boots.

        Parameters
        ----------
        earlier
            Earlier result of this method for the channel.
        """
        best = replace(self, rate_hz=self.best_hz)
        if earlier is None or earlier.source != self.source:
            return best if earlier is None or not self.best_hz <= earlier.rate_hz else earlier
        return replace(
            best,
            rate_hz=float(np.fmax(self.best_hz, earlier.rate_hz)),
            lowest=float(np.fmin(self.lowest, earlier.lowest)),
            highest=float(np.fmax(self.highest, earlier.highest)),
        )


class Track:
    """Buffer of samples that grows at its end and drops its beginning.

    Late packets are kept, and are sorted in when a stretch is cut. Duplicate samples are dropped when a
    stretch is cut. Gaps, rates and ranges are counted when somebody asks, because samples arrive in
    many small batches.
    """

    def __init__(self, name: str, source: str, provenance: str) -> None:
        self.name = name
        self.source = source
        self.provenance = provenance
        self.newest_s = -np.inf
        self.newest = np.nan
        """Value of the sample with the newest stamp, ``newest_s``."""
        self._largest_gap_s = 0.0
        self._best = BestRate()
        self._lowest, self._highest = np.inf, -np.inf
        self._extremes = Extremes()
        self._counted, self._counted_s = 0, np.nan
        """Number of samples in the buffer that are counted, and the newest stamp of all counted samples."""
        self._t = np.empty(1024)
        self._y = np.empty(1024)
        self._order = np.empty(1024, dtype=np.int64)
        self._size = 0
        self._keep_from_s = -np.inf
        self._status: ChannelStatus | None = None

    def append(self, t: FloatArray, y: FloatArray, order: IntArray) -> None:
        """Take samples in order of arrival."""
        if len(t) == 0:
            return
        self._status = None
        latest = int(t.argmax())
        if t[latest] > self.newest_s:
            self.newest_s, self.newest = float(t[latest]), float(y[latest])
        self._make_room(len(t))
        new = slice(self._size, self._size + len(t))
        self._t[new], self._y[new], self._order[new] = t, y, order
        self._size = new.stop

    @property
    def lowest(self) -> float:
        """Smallest value since boot, SI."""
        self._count()
        return self._lowest

    @property
    def highest(self) -> float:
        """Largest value since boot, SI."""
        self._count()
        return self._highest

    @property
    def extremes(self) -> Extremes:
        """Extremes of the whole power-on, in bounded memory."""
        self._count()
        return self._extremes

    def forget(self, before_s: float) -> None:
        """Drop samples older than ``before_s`` when room is needed."""
        self._keep_from_s = before_s

    def cut(self, start_s: float, end_s: float, up_to_order: int | None = None) -> Channel:
        """Return the samples with ``start_s <= t <= end_s`` that had arrived by ``up_to_order``."""
        t, y = self._t[: self._size], self._y[: self._size]
        wanted = (t >= start_s) & (t <= end_s)
        if up_to_order is not None:
            wanted &= self._order[: self._size] <= up_to_order
        t, y = t[wanted], y[wanted]
        t, first = np.unique(t, return_index=True)
        return Channel(self.name, t, y[first], self.source, self.provenance)

    @property
    def status(self) -> ChannelStatus:
        if self._status is not None:
            return self._status
        self._count()
        recent = self.cut(self.newest_s - 10.0, self.newest_s)
        gap = self._largest_gap_s if self._size > 1 else float("inf")
        span = float(recent.t[-1] - recent.t[0]) if len(recent) > 1 else 0.0
        rate = (len(recent) - 1) / span if span > 0.0 else float("nan")
        self._status = ChannelStatus(
            self.source,
            self.provenance,
            rate,
            gap,
            self.newest_s,
            self._best.rate_hz,
            self._lowest,
            self._highest,
            self.newest,
        )
        return self._status

    def _count(self) -> None:
        """Count the samples since the last call."""
        t, y = self._t[self._counted : self._size], self._y[self._counted : self._size]
        if len(t) == 0:
            return
        before = t[0] if np.isnan(self._counted_s) else self._counted_s
        newest = np.maximum.accumulate(np.concatenate(([before], t)))
        self._largest_gap_s = max(self._largest_gap_s, float((newest[1:] - newest[:-1]).max()))
        self._counted, self._counted_s = self._size, float(newest[-1])
        self._best.add(t)
        self._extremes.add(t, y)
        self._lowest, self._highest = min(self._lowest, float(y.min())), max(self._highest, float(y.max()))

    def _make_room(self, n: int) -> None:
        if self._size + n <= len(self._t):
            return
        self._count()
        kept = self._t[: self._size] >= self._keep_from_s
        size = int(np.count_nonzero(kept))
        capacity = max(1024, 2 * (size + n))
        for name in ("_t", "_y", "_order"):
            old = getattr(self, name)
            grown = np.empty(capacity, dtype=old.dtype)
            grown[:size] = old[: self._size][kept]
            setattr(self, name, grown)
        self._size = self._counted = size
        self._counted_s = self._counted_s if size else np.nan


SEA_LEVEL_DENSITY_KG_M3 = 1.225
"""Air density at sea level, kg/m³."""
_SEA_LEVEL_K = 288.15
_SEA_LEVEL_PA = 101_325.0
_CELSIUS_K = 273.15
_LAPSE_K_M = 0.0065
_EXPONENT = 4.255876
"""Exponent g/(R·lapse) - 1 of the standard atmosphere below 11 km."""
_GAS_CONSTANT = 287.05287
"""Gas constant of dry air, J/(kg·K)."""
PLAUSIBLE = {"static_pressure": (2.2e4, 1.1e5), "altitude": (-500.0, 11_000.0)}
"""Plausible range of a channel below the tropopause, Pa or m. A value of zero indicates a missing sensor."""


def standard_pressure(height_m: float | FloatArray) -> FloatArray:
    """Return the pressure in Pa at heights above mean sea level, below 11 km."""
    return np.asarray(_SEA_LEVEL_PA * (1.0 - _LAPSE_K_M * height_m / _SEA_LEVEL_K) ** (_EXPONENT + 1.0))


def standard_density(pressure_pa: float | FloatArray) -> FloatArray:
    """Return the density in kg/m³ at pressures in Pa, below 11 km."""
    return np.asarray(
        SEA_LEVEL_DENSITY_KG_M3 * (pressure_pa / _SEA_LEVEL_PA) ** (_EXPONENT / (_EXPONENT + 1.0))
    )


def standard_height(density_kg_m3: float | FloatArray) -> FloatArray:
    """Return the height in m, below 11 km, with this density in the standard atmosphere."""
    ratio = np.asarray(density_kg_m3) / SEA_LEVEL_DENSITY_KG_M3
    return np.asarray(_SEA_LEVEL_K / _LAPSE_K_M * (1.0 - ratio ** (1.0 / _EXPONENT)))


def density(pressure_pa: float | FloatArray, temperature_c: float | None) -> FloatArray:
    """Return the density of dry air in kg/m³, at the standard temperature if none is known."""
    if temperature_c is None:
        return standard_density(pressure_pa)
    return np.asarray(pressure_pa / (_GAS_CONSTANT * (temperature_c + _CELSIUS_K)))


BY_PRESSURE = ", true by the static pressure"
"""End of the source name of an air speed corrected to true by the static pressure."""
AS_REPORTED = ", true as reported"
"""End of the source name of an air speed that a simulator reports as true."""
AS_GROUND_SPEED = ", equal to the ground speed"
"""End of the source name of an air speed that equals the ground speed in every sample. A ground speed is not
based on pressure, so it needs no density correction."""
BY_HEIGHT = ", true by the height"
"""End of the source name of an air speed corrected to true by the height."""


def is_true(airspeed: Channel) -> bool:
    """Return whether an air speed is true. An air speed that stays as logged may be indicated."""
    source = airspeed.source
    return source in (GIVEN_AIRSPEED, TRUE_AIRSPEED) or source.endswith(
        (BY_PRESSURE, BY_HEIGHT, AS_REPORTED, AS_GROUND_SPEED)
    )


def true_airspeed(
    logged: Channel, pressure: Channel | None, altitude: Channel | None, temperature_c: float | None
) -> Channel:
    """Return the true air speed for a logged air speed; unchanged without a density.

    Parameters
    ----------
    logged
        Logged air speed, m/s.
    pressure, altitude
        Static pressure in Pa, and height above mean sea level in m, around that time; None if missing.
    temperature_c
        Air temperature from the aircraft file, deg C; None for the standard atmosphere.
    """
    if is_true(logged):
        return logged
    measured, high = _plausible(pressure), _plausible(altitude)
    if measured is not None:
        at, pressure_pa, by = measured.t, measured.y, BY_PRESSURE
    elif high is not None:
        at, pressure_pa, by = high.t, standard_pressure(high.y), BY_HEIGHT
    else:
        return logged
    ratio: FloatArray = np.sqrt(SEA_LEVEL_DENSITY_KG_M3 / density(pressure_pa, temperature_c))
    true = logged.y * np.interp(logged.t, at, ratio)
    return replace(logged, y=true, source=f"{logged.source}{by}", gain=float(np.mean(ratio)))


def true_over_read(records: Iterable[Mapping[str, Channel]]) -> float:
    """Return the mean factor from the read to the true air speed; 1 without an air speed.

    A crew states a reference speed as its instrument reads it.
    """
    gains = [channels["airspeed"].gain for channels in records if "airspeed" in channels]
    return float(np.mean(gains)) if gains else 1.0


def _plausible(channel: Channel | None) -> Channel | None:
    """Return the samples within the plausible range of an atmosphere; None without any."""
    if channel is None:
        return None
    low, high = PLAUSIBLE[channel.name]
    good = (channel.y >= low) & (channel.y <= high)
    # A log without the height above sea level has zeros in its place.
    good &= channel.y != 0.0
    return replace(channel, t=channel.t[good], y=channel.y[good]) if good.any() else None
