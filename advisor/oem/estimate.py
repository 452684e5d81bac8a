"""Result of an estimation: values, errors, and the quality of the fit."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import nan
from typing import ClassVar, Self

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.oem.known_instruments import FoundInstruments, InstrumentName
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ChannelFit:
    """Measured and fitted values of one output at the output's own stamps."""

    name: str
    t: FloatArray
    measured: FloatArray
    fitted: FloatArray
    noise: float
    """Estimated standard deviation of the measurement noise, SI of the channel."""

    @property
    def residual(self) -> FloatArray:
        """Residual: measured minus fitted values, ν̂ of Eq. (9)."""
        return self.measured - self.fitted

    @property
    def rms(self) -> float:
        """Root mean square of the residual, in the channel's SI unit."""
        return float(np.sqrt(np.mean(self.residual**2)))

    @property
    def r2(self) -> float:
        """Share of the measured variance that the fit explains."""
        spread = float(np.var(self.measured))
        return 1.0 - self.rms**2 / spread if spread > 0.0 else float("nan")

    @property
    def tic(self) -> float:
        """Theil's inequality coefficient, 0 (perfect) to 1."""
        size = np.sqrt(np.mean(self.measured**2)) + np.sqrt(np.mean(self.fitted**2))
        return self.rms / float(size) if size > 0.0 else float("nan")

    @property
    def lag1(self) -> float:
        """Lag-1 autocorrelation of the residual: 0 for white, near 1 for coloured residuals."""
        v = self.residual - np.mean(self.residual)
        power = float(v @ v)
        return float(v[1:] @ v[:-1]) / power if power > 0.0 else 0.0


@dataclass(frozen=True, slots=True)
class InstrumentEstimate:
    """An instrument parameter that was estimated together with the derivatives."""

    name: InstrumentName
    value: float
    """Parameter value in use, in the unit at the end of the name."""
    std: float
    """Standard deviation of ``value``, corrected for coloured residuals."""
    stated: float | None = None
    """Value of the parameter in the aircraft file. None if the file states no value."""
    unstated_value: float = nan
    """Value from the data without the stated value; NaN without a statement."""
    unstated_std: float = nan
    """Standard deviation of ``unstated_value``, corrected for coloured residuals."""
    contradicts: bool = False
    """Whether the data exclude the stated value; ``value`` then comes from the data."""


@dataclass(frozen=True, slots=True)
class TermEstimate:
    """Coefficient of a term that the user added."""

    name: str
    """Term as the user wrote it: ``M:q*abs(q)``."""
    value: float
    std: float
    """Standard deviation of ``value``, corrected for coloured residuals."""
    gained: float
    """Log likelihood of the fit with the term minus that of the fit without it, nats; NaN without a fit."""


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """Parameters of one axis from one manoeuvre or several, by default those of Eq. (3).

    Two estimates, fits or channels are equal only if they are one object, because arrays do not compare to
    one truth.
    """

    COLOUR_IS_SHARED: ClassVar[bool] = True
    """Whether the residuals of all manoeuvres of one flight have one colour."""

    @property
    def of_prior(self) -> tuple[str, ...]:
        """Names of the parameters whose values come from priors, because the test does not move their
        control."""
        return ()

    theta: FloatArray
    """Shape (8,): parameter values in the order of ``names``. In a joint estimate Z_0 and M_0 are means over
    the manoeuvres."""
    covariance_cr: FloatArray
    """Shape (8, 8): Cramér-Rao bound, which holds for white residuals. """
    covariance: FloatArray
    """Shape (8, 8): covariance, corrected for coloured residuals. """
    cost: float
    """Least J = det R of Eq. (7) over angle of attack and pitch rate, or over pitch rate and a_z without
    α."""
    fits: tuple[Mapping[str, ChannelFit], ...]
    """Fit of each output at the lowest cost, by its name, in one mapping per manoeuvre."""
    iterations: int
    not_identifiable: Mapping[str, str]
    """Reason why a parameter has no usable value, by the parameter's name."""
    correlated: tuple[tuple[str, str, float], ...]
    """Pairs of parameters with an absolute correlation above 0.9."""
    condition: float
    """Condition number of the unit-diagonal information matrix."""
    airspeed_m_s: float | None
    """Air speed of the derivatives, m/s; None without a measured air speed."""
    notes: tuple[str, ...] = ()
    """Sentences that inform the user about these values."""
    instruments: tuple[InstrumentEstimate, ...] = ()
    """Instrument parameters that the data determine, with the values of this estimate."""
    found: FoundInstruments | None = None
    """All instrument parameters of the fit, including those that only priors determine. None if the estimate
    contains no instruments."""
    common: FloatArray = field(default_factory=lambda: np.zeros((len(PARAMETERS), len(PARAMETERS))))
    """Shape (8, 8): part of ``covariance`` that is common to all estimates with these instruments."""
    given: FoundInstruments | None = None
    """Instruments that several manoeuvres determined together, with the errors in ``common``."""
    gust_rad: float | None = None
    """Standard deviation of the gust angle w/V, rad; None in still air."""
    filtered: bool = False
    """Whether ``theta`` comes from filter error, which allows for moving air and coloured instruments."""
    servo_lag_s: float = 0.0
    """First-order lag of the servo in this estimate, s, stated or estimated."""
    prediction: Mapping[str, float] = field(default_factory=dict)
    """Largest half-width of each predicted output's 95 % band, over the response's peak, by the output's
    name. The mapping is empty while a manoeuvre is being flown."""
    terms: tuple[TermEstimate, ...] = ()
    """Terms that the user added."""
    fixed: tuple[str, ...] = ()
    """Names of the parameters that the user holds at a value."""
    names: tuple[str, ...] = PARAMETERS
    """Names of the parameters."""

    @property
    def structured(self) -> Self | None:
        """The estimate if the user holds a parameter or adds a term; None otherwise."""
        return self if self.fixed or self.terms else None

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs that the fit uses."""
        return tuple(self.fits[0])

    def instrument(self, name: str) -> InstrumentEstimate | None:
        """Return the estimate of one instrument parameter; None if the data do not determine it."""
        return next((x for x in self.instruments if x.name == name), None)

    @property
    def std(self) -> FloatArray:
        """Shape (8,): standard deviations, corrected for coloured residuals."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def std_cr(self) -> FloatArray:
        """Shape (8,): Cramér-Rao standard deviations."""
        return np.sqrt(np.diag(self.covariance_cr))

    @property
    def own_covariance(self) -> FloatArray:
        """Shape (8, 8): covariance for given instruments, corrected for coloured residuals."""
        return self.covariance - self.common

    @property
    def own_covariance_cr(self) -> FloatArray:
        """Shape (8, 8): Cramér-Rao bound for given instruments."""
        return self.covariance_cr - self.common

    def value(self, parameter: str) -> float:
        """Return the value of one parameter by name."""
        return float(self.theta[self.names.index(parameter)])


@dataclass(frozen=True, slots=True)
class NoEstimate:
    """Reason for a missing estimate; a numerical failure is a value, not an exception."""

    code: str
    """Code of the reason: ``too_few_samples``, ``no_input``, ``not_converged``, ``singular``, ..."""
    text: str
    """Sentence about the reason, for people."""
