"""Instruments as several manoeuvres together tell them, for the estimate from each of these manoeuvres.

One manoeuvre hardly tells a servo's lag from M_q and M_δe. All manoeuvres of a power-on share their
instruments and tell them well. The joint estimate tells the instruments, and each manoeuvre's estimate takes
their values as given. The error of an instrument's estimate has two parts. One part is the manoeuvre's own,
for given instruments. The other part comes from the errors of the instruments, and all manoeuvres have it in
common. Further manoeuvres average out the first part alone.
"""

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS, SPEED_EXPONENTS
from advisor.flight.signals.messages import FloatArray

InstrumentName = Literal[
    "servo_lag_s",
    "command_delay_s",
    "vane_arm_m",
    "alpha_delay_s",
    "accelerometer_arm_m",
    "steady_moment_rad",
]
_SPEED_POWER = np.array([SPEED_EXPONENTS[name] for name in PARAMETERS], dtype=float)


@dataclass(frozen=True, eq=False, slots=True)
class FoundInstruments:
    """Instrument parameters of a fit, with their errors and with those that they cause."""

    names: tuple[InstrumentName, ...]
    values: FloatArray
    """(k,) in the units that end the names."""
    std: FloatArray
    """(k,) standard deviations."""
    covariance: FloatArray
    """(8, 8) covariance of the derivatives by the errors of the instruments, at ``airspeed_m_s``."""
    airspeed_m_s: float | None
    """Air speed of the derivatives, m/s. None: no air speed was measured."""

    @classmethod
    def of(
        cls,
        names: tuple[InstrumentName, ...],
        values: FloatArray,
        covariance: FloatArray,
        airspeed_m_s: float | None,
    ) -> "FoundInstruments":
        """Return the instruments of a fit.

        Parameters
        ----------
        names, values
            The k instruments.
        covariance
            (8 + k, 8 + k) covariance of the parameters and then of the instruments. The regression of the
            parameters' errors on those of the instruments gives the part that the instruments cause.
        airspeed_m_s
            Air speed of the derivatives.
        """
        n = len(PARAMETERS)
        inside = slice(n, n + len(names))
        own, across = covariance[inside, inside], covariance[:n, inside]
        return cls(
            names,
            values,
            np.sqrt(np.diag(own)),
            across @ np.linalg.pinv(own, hermitian=True) @ across.T,
            airspeed_m_s,
        )

    def value(self, name: InstrumentName) -> float | None:
        """Return one value; None where the fit had no such parameter."""
        return float(self.values[self.names.index(name)]) if name in self.names else None

    def without(self, name: InstrumentName) -> "FoundInstruments":
        """Return all parameters but one."""
        kept = [i for i, one in enumerate(self.names) if one != name]
        names = tuple(self.names[i] for i in kept)
        return FoundInstruments(names, self.values[kept], self.std[kept], self.covariance, self.airspeed_m_s)

    def covariance_at(self, airspeed_m_s: float | None) -> FloatArray:
        """Return the (8, 8) covariance by the errors of the instruments at an air speed."""
        if not self.airspeed_m_s or not airspeed_m_s:
            return self.covariance
        scale = (airspeed_m_s / self.airspeed_m_s) ** _SPEED_POWER
        return np.asarray(self.covariance * np.outer(scale, scale))


@dataclass(frozen=True)
class AircraftInFlight(Aircraft):
    """The crew's aircraft, with the instruments that its manoeuvres have told together."""

    found: FoundInstruments | None = None


def found_of(aircraft: Aircraft) -> FoundInstruments | None:
    """Return the instruments that manoeuvres have told together; None before."""
    return aircraft.found if isinstance(aircraft, AircraftInFlight) else None


def with_found(aircraft: Aircraft, found: FoundInstruments) -> AircraftInFlight:
    """Return the crew's aircraft with instruments that its manoeuvres have told."""
    as_stated = {one.name: getattr(aircraft, one.name) for one in fields(Aircraft)}
    return AircraftInFlight(**as_stated, found=found)
