"""Instrument values from several manoeuvres together, for the estimate from each single manoeuvre.

One manoeuvre hardly distinguishes a servo's lag from M_q and M_δe. All manoeuvres of a power-on share their
instruments and determine them well together. The joint estimate determines the instruments, and each
manoeuvre's estimate uses these values. The error of such an estimate has two parts. One part is the
manoeuvre's own error, for given instruments. The other part comes from the instruments' errors and is common
to all manoeuvres. More manoeuvres average out the first part. The second part falls as the data determine the
instruments better, down to the part that only priors determine.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Self

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS, SPEED_EXPONENTS
from advisor.oem.extra import Prior
from advisor.process.arrays import FloatArray

InstrumentName = str
"""Name of an instrument parameter, or the text of a term that the user added."""
_Row = tuple[InstrumentName, float, Prior | None]
"""Name, value and prior of an instrument."""
_SPEED_POWER = np.array([SPEED_EXPONENTS[name] for name in PARAMETERS], dtype=float)


@dataclass(frozen=True, eq=False, slots=True)
class FoundInstruments:
    """Instrument parameters of a fit, with their errors and the derivative errors they cause."""

    names: tuple[InstrumentName, ...]
    values: FloatArray
    """Shape (k,): values of the instruments, in the units at the end of the names."""
    std: FloatArray
    """Shape (k,): standard deviations of the instruments."""
    covariance: FloatArray
    """Shape (8, 8): covariance of the derivatives due to the instruments' errors, at ``airspeed_m_s``."""
    airspeed_m_s: float | None
    """Air speed of the derivatives, m/s. None without a measured air speed."""
    parts: FloatArray = field(default_factory=lambda: np.zeros((len(PARAMETERS), 0)))
    """Shape (8, k): parts of the derivatives' variances by independent combinations of the instruments."""
    by_prior: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Shape (k,): share of each combination's information that comes from priors, 0 to 1."""

    @classmethod
    def of(cls, rows: Sequence[_Row], covariance: FloatArray, airspeed_m_s: float | None) -> Self:
        """Return the instruments of a fit.

        Parameters
        ----------
        rows
            Name, value and prior of the k instruments; None without a prior.
        covariance
            Shape (8 + k, 8 + k): covariance of the parameters, then of the instruments. The regression of
            parameter errors on instrument errors gives the part that the instruments cause.
        airspeed_m_s
            Air speed of the derivatives, m/s.
        """
        n = len(PARAMETERS)
        own, across = covariance[n : n + len(rows), n : n + len(rows)], covariance[:n, n : n + len(rows)]
        slopes = across @ np.linalg.pinv(own, hermitian=True)
        sizes, axes = np.linalg.eigh(own)
        root = axes * np.sqrt(np.maximum(sizes, 0.0))
        before = np.diag([0.0 if prior is None else prior.std**-2.0 for _, _, prior in rows])
        by_prior, turned = np.linalg.eigh(root.T @ before @ root)
        names, values, std = tuple(row[0] for row in rows), [row[1] for row in rows], np.sqrt(np.diag(own))
        parts, by_prior = (slopes @ root @ turned) ** 2, np.clip(by_prior, 0.0, 1.0)
        return cls(names, np.array(values), std, slopes @ across.T, airspeed_m_s, parts, by_prior)

    def stays(self, times: float) -> FloatArray:
        """Return the share (8,) of each variance in ``covariance`` that stays with ``times`` as many data."""
        later = np.sum(self.parts / (self.by_prior + times * (1.0 - self.by_prior)), axis=1)
        return np.asarray(later / np.maximum(self.parts.sum(axis=1), np.finfo(float).tiny))

    def value(self, name: InstrumentName) -> float | None:
        """Return the value of one instrument; None if the fit had no such parameter."""
        return float(self.values[self.names.index(name)]) if name in self.names else None

    def without(self, name: InstrumentName) -> "FoundInstruments":
        """Return all instruments but one."""
        kept = [i for i, own in enumerate(self.names) if own != name]
        names = tuple(self.names[i] for i in kept)
        return replace(self, names=names, values=self.values[kept], std=self.std[kept])

    def covariance_at(self, airspeed_m_s: float | None) -> FloatArray:
        """Return the derivatives' covariance (8, 8) due to the instruments' errors, at an air speed."""
        ratio = airspeed_m_s / self.airspeed_m_s if airspeed_m_s and self.airspeed_m_s else 1.0
        scale = ratio**_SPEED_POWER
        return np.asarray(self.covariance * np.outer(scale, scale))


@dataclass(frozen=True)
class AircraftInFlight(Aircraft):
    """The crew's aircraft, with instruments that its manoeuvres determined together."""

    found: FoundInstruments | None = None


def found_of(aircraft: Aircraft) -> FoundInstruments | None:
    """Return the instruments that manoeuvres determined together; None if there are none yet."""
    return aircraft.found if isinstance(aircraft, AircraftInFlight) else None


def with_found(aircraft: Aircraft, found_instruments: FoundInstruments) -> AircraftInFlight:
    """Return the crew's aircraft with instruments that its manoeuvres determined."""
    as_stated = {attribute.name: getattr(aircraft, attribute.name) for attribute in fields(Aircraft)}
    return AircraftInFlight(**as_stated, found=found_instruments)
