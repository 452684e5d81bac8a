"""Vibration of a log: power spectra, lines and clipped samples; and fields that a person asks for by name."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import numpy as np
from scipy.signal import welch
from scipy.stats import f as variance_ratio

from advisor.aircraft.aircraft import TableColumns
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.mavlink.logs.raw_fields import RawTable, names_in, read_raw
from advisor.process.arrays import FloatArray
from advisor.words.problems import ConfigurationError


@dataclass(frozen=True, slots=True)
class FieldSum:
    """One field of a log, or the sum of several, in the log's units."""

    name: str
    """Name as the user wrote it: ``RCOU.C1+RCOU.C3``."""
    t: FloatArray
    """Shape (n,), stamps of the first field, s since power-on."""
    y: FloatArray
    """Shape (n,), sum of the fields. All fields but the first are interpolated at ``t``. NaN where
    a field has no samples."""


def field_sums(log: Path, asked: Sequence[str]) -> tuple[FieldSum, ...]:
    """Return the fields that are asked for.

    Parameters
    ----------
    asked
        Names, each ``MESSAGE.FIELD`` as in the log, or several fields joined by ``+``.

    Raises
    ------
    ConfigurationError
        A field is not in the log.
    UnusableInputError
        The log cannot be read.
    """
    if not asked:
        return ()
    parts = [[part.strip() for part in text.split("+")] for text in asked]
    tables = read_raw(log, {part.partition(".")[0].partition("[")[0] for sums in parts for part in sums})
    _refuse_unknown(log, [part for sums in parts for part in sums], tables)
    return tuple(_summed(text, sums, tables) for text, sums in zip(asked, parts, strict=True))


def _refuse_unknown(log: Path, parts: Sequence[str], tables: Mapping[str, RawTable]) -> None:
    there = {f"{name}.{field}" for name, table in tables.items() for field in table.fields}
    unknown = [part for part in parts if part not in there]
    if not unknown:
        return
    defined = {f"{name}.{field}": None for name, fields in names_in(log).items() for field in fields}
    every = {name.lower(): name for name in (*defined, *there)}
    said = []
    for part in dict.fromkeys(unknown):
        near = [every[name] for name in get_close_matches(part.lower(), every) if every[name] != part]
        nearest = f"; nearest: {', '.join(near)}" if near else "; names are MESSAGE.FIELD as in the log"
        said.append(f"--field {part}: {log.name} has no numbers under this name{nearest}.")
    raise ConfigurationError("\n".join(said))


def _summed(text: str, parts: Sequence[str], tables: Mapping[str, RawTable]) -> FieldSum:
    t = tables[parts[0].partition(".")[0]].t
    y = np.zeros(len(t))
    for part in parts:
        name, _, field = part.partition(".")
        y += np.interp(t, tables[name].t, tables[name].fields[field], left=np.nan, right=np.nan)
    return FieldSum(text, t, y)


_ACCELEROMETER, _GYRO = ("accelerometer", "m/s²"), ("gyro", "rad/s")
_MILLI = (
    (*_ACCELEROMETER, ("xacc", "yacc", "zacc"), 1e-3 * GRAVITY_M_S2),
    (*_GYRO, ("xgyro", "ygyro", "zgyro"), 1e-3),
)
_SENSORS = {
    "IMU": (
        (*_ACCELEROMETER, ("AccX", "AccY", "AccZ"), 1.0),
        (*_GYRO, ("GyrX", "GyrY", "GyrZ"), 1.0),
    ),
    "HIGHRES_IMU": (
        (*_ACCELEROMETER, ("xacc", "yacc", "zacc"), 1.0),
        (*_GYRO, ("xgyro", "ygyro", "zgyro"), 1.0),
    ),
    **dict.fromkeys(("RAW_IMU", "SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3"), _MILLI),
}
"""Sensor, unit, fields and factor of each message. ArduPilot sends RAW_IMU in mg and mrad/s as well."""
_CLIPPING = {
    "VIBE": ("Clip", "Clip0", "Clip1", "Clip2"),
    "VIBRATION": ("clipping_0", "clipping_1", "clipping_2"),
}
SEGMENT_S = 20.0
"""Length of a segment of the spectrum, s. Its resolution, 0.05 Hz, separates a line from the broad response
of a short period to gusts."""
FEWEST_SEGMENTS = 4
"""Least number of segments without overlap, from which the spread of a density is known."""
_GAP = 5.0
"""Largest interval between samples within a segment, in median intervals. The doctor uses an equal limit for
gaps of a link.
"""
FALSE_LINES = 1e-3
"""Probability that a spectrum without lines seems to have a line: one wrong note in a thousand spectra."""
_LOBE, _NEIGHBOURS = 3, 6
"""Number of bins in a line's main lobe by a Hann window (2), plus one, and the last bin of the line's
neighbourhood.
"""


@dataclass(frozen=True, slots=True)
class Spectrum:
    """Power spectral density of one sensor's three axes, as the median of the segments.

    The median leaves out manoeuvres, which fill fewer than half of the segments.
    """

    name: str
    """Message and sensor: ``IMU[1] accelerometer``."""
    unit: str
    rate_hz: float
    frequency_hz: FloatArray
    """Shape (n,), up to half of the rate."""
    density: FloatArray
    """Shape (3, n), unit² / Hz."""
    segments: int
    """Number of segments without overlap."""

    @property
    def highest_hz(self) -> float:
        """Highest frequency that the log's rate shows, Hz."""
        return 0.5 * self.rate_hz

    @property
    def rms(self) -> FloatArray:
        """Root mean square of each axis without its mean, shape (3,), in the sensor's unit."""
        power: FloatArray = np.sum(self.density[:, 1:], axis=1) * self.frequency_hz[1]
        return np.sqrt(power)

    def line_hz(self, up_to_hz: float) -> float | None:
        """Return the frequency of the strongest line up to a frequency; None without a line.

        A line exceeds each neighbour outside of its main lobe by more than chance allows (ratio of two
        variances, Bonferroni over all bins).
        """
        inside = range(_NEIGHBOURS, len(self.frequency_hz) - _NEIGHBOURS)
        bins = [k for k in inside if self.frequency_hz[k] <= up_to_hz]
        if self.segments < FEWEST_SEGMENTS or not bins:
            return None
        limit = float(variance_ratio.isf(FALSE_LINES / (3 * len(bins)), 2 * self.segments, 2 * self.segments))
        away = [k for k in range(-_NEIGHBOURS, _NEIGHBOURS + 1) if abs(k) >= _LOBE]
        around = np.max([self.density[:, np.array(bins) + k] for k in away], axis=0)
        ratio = np.max(self.density[:, bins] / np.maximum(around, np.finfo(float).tiny), axis=0)
        best = int(np.argmax(ratio))
        return float(self.frequency_hz[bins[best]]) if ratio[best] > limit else None


@dataclass(frozen=True, slots=True)
class Vibration:
    """Spectra of all sensors, and clipped samples."""

    spectra: tuple[Spectrum, ...]
    clipped: Mapping[str, int]
    """Growth of each count of clipped samples within the log, by message and field."""

    def notes(self, unit_s: float | None) -> Iterator[str]:
        """Yield a sentence about growing counts, and one about a line in the band of the test.

        Parameters
        ----------
        unit_s
            Unit step of the test, s, whose pulse has its first zero at 1 / ``unit_s``. None: no band.
        """
        grown = [f"{name} by {count}" for name, count in self.clipped.items() if count > 0]
        if grown:
            yield f"Accelerometers clip ({', '.join(grown)} samples): damp the vibration of their mount."
        lines = [(s, s.line_hz(1.0 / unit_s)) for s in self.spectra] if unit_s else []
        peaks = [f"{s.name}: peak at {hz:.2f} Hz" for s, hz in lines if hz is not None]
        if peaks:
            yield f"A vibration line lies in the frequency band of the test ({'; '.join(peaks)})."


def vibration_of(log: Path, columns: TableColumns | None = None) -> Vibration:
    """Return the vibration of a log.

    Parameters
    ----------
    columns
        Names of a table's columns; None for usual names.

    Raises
    ------
    UnusableInputError
        The log cannot be read.
    """
    tables = read_raw(log, (*_SENSORS, *_CLIPPING), columns)
    spectra = [spectrum for name, table in tables.items() for spectrum in _spectra(name, table)]
    clipped = {
        f"{name}.{field}": int(np.sum(np.maximum(np.diff(table.fields[field]), 0.0)))
        for name, table in tables.items()
        for field in _CLIPPING.get(_message(name), ())
        if field in table.fields
    }
    return Vibration(tuple(spectra), clipped)


def _message(name: str) -> str:
    return name.partition("[")[0]


def _spectra(name: str, table: RawTable) -> Iterator[Spectrum]:
    for sensor, unit, fields, factor in _SENSORS.get(_message(name), ()):
        if all(field in table.fields for field in fields):
            samples = factor * np.array([table.fields[field] for field in fields])
            made = spectrum(f"{name} {sensor}", unit, table.t, samples)
            if made is not None:
                yield made


def spectrum(name: str, unit: str, t: FloatArray, samples: FloatArray) -> Spectrum | None:
    """Return the spectrum of the longest stretch without a gap; None for a stretch without a segment.

    Parameters
    ----------
    t : shape (n,)
        Times, s, ascending.
    samples : shape (3, n)
        Samples of the three axes.
    """
    fresh = np.concatenate([[True], np.diff(t) > 0.0]) & np.all(np.isfinite(samples), axis=0)
    t, samples = t[fresh], samples[:, fresh]
    if len(t) < 2:
        return None
    edges = np.flatnonzero(np.diff(t) > _GAP * np.median(np.diff(t))) + 1
    stretches = np.split(np.arange(len(t)), edges)
    longest = max(stretches, key=len)
    if len(longest) < 2:
        return None
    length_s = float(t[longest[-1]] - t[longest[0]])
    rate_hz = (len(longest) - 1) / length_s
    size = round(SEGMENT_S * rate_hz)
    if size < 2 or len(longest) < size:
        return None
    with np.errstate(over="ignore", invalid="ignore"):  # damaged records hold any number
        at, density = welch(samples[:, longest], rate_hz, nperseg=size, average="median")
    if not np.all(np.isfinite(density)):
        return None
    return Spectrum(name, unit, rate_hz, at, density, len(longest) // size)
