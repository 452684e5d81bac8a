"""The result of an estimation: values, errors, and the quality of the fit."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import nan
from typing import ClassVar

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.flight.signals.messages import FloatArray
from advisor.oem.known_instruments import FoundInstruments, InstrumentName


@dataclass(frozen=True, slots=True, eq=False)
class ChannelFit:
    """Measured and fitted values of one output at its own stamps."""

    name: str
    t: FloatArray
    measured: FloatArray
    fitted: FloatArray
    noise: float
    """Estimated standard deviation of the measurement noise, SI of the channel."""

    @property
    def residual(self) -> FloatArray:
        """Measured minus fitted, ν̂ of Eq. (9)."""
        return self.measured - self.fitted

    @property
    def rms(self) -> float:
        """Root mean square of the residual, SI of the channel."""
        return float(np.sqrt(np.mean(self.residual**2)))

    @property
    def r2(self) -> float:
        """Share of the measured variance explained."""
        spread = float(np.var(self.measured))
        return 1.0 - self.rms**2 / spread if spread > 0.0 else float("nan")

    @property
    def tic(self) -> float:
        """Theil's inequality coefficient, 0 (perfect) to 1."""
        size = np.sqrt(np.mean(self.measured**2)) + np.sqrt(np.mean(self.fitted**2))
        return self.rms / float(size) if size > 0.0 else float("nan")

    @property
    def lag1(self) -> float:
        """Lag-1 autocorrelation of the residual: 0 when white, near 1 when coloured."""
        v = self.residual - np.mean(self.residual)
        power = float(v @ v)
        return float(v[1:] @ v[:-1]) / power if power > 0.0 else 0.0


@dataclass(frozen=True, slots=True)
class InstrumentEstimate:
    """A parameter of the instruments that was estimated together with the derivatives."""

    name: InstrumentName
    value: float
    """Value in use, in the unit that ends the name."""
    std: float
    """Standard deviation of ``value``, corrected for coloured residuals."""
    stated: float | None = None
    """Value in the aircraft file. None: the file states no value."""
    unstated_value: float = nan
    """Value that the data tell without the statement; NaN without a statement."""
    unstated_std: float = nan
    """Standard deviation of ``unstated_value``, corrected for coloured residuals."""
    contradicts: bool = False
    """Whether the data exclude the stated value; ``value`` is then theirs."""


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """The parameters of one axis from one manoeuvre, or from several together: by default those of Eq. (3).

    Estimates, fits and channels are equal where they are one object: == of arrays has no single truth.
    """

    COLOUR_IS_SHARED: ClassVar[bool] = True
    """Whether residuals of all manoeuvres of one flight have one colour."""

    theta: FloatArray
    """Shape (8,), in the order of ``names``. In a joint estimate Z_0 and M_0 are means over manoeuvres."""
    covariance_cr: FloatArray
    """Shape (8, 8). Cramér-Rao bound, which holds for white residuals."""
    covariance: FloatArray
    """Shape (8, 8). The covariance is corrected for coloured residuals."""
    cost: float
    """Lowest J = det R of Eq. (7) over angle of attack and pitch rate; without an angle of attack over pitch
    rate and a_z."""
    fits: tuple[Mapping[str, ChannelFit], ...]
    """One mapping of output name to fit per manoeuvre, at the lowest cost."""
    iterations: int
    not_identifiable: Mapping[str, str]
    """Parameter name to the reason why the parameter has no usable value."""
    correlated: tuple[tuple[str, str, float], ...]
    """Pairs of parameters with |correlation| above 0.9."""
    condition: float
    """Condition number of the normalised information matrix."""
    airspeed_m_s: float | None
    """Speed of the derivatives, m/s; None where no air speed was measured."""
    notes: tuple[str, ...] = ()
    """Sentences that the user must know about these values."""
    theta_of_lowest_cost: FloatArray | None = None
    """Shape (8,), the parameters of ``cost`` and ``fits`` where they differ from ``theta``. With coloured
    noise or in moving air the smallest error lies at another point (``efficient``, ``filter_error``)."""
    instruments: tuple[InstrumentEstimate, ...] = ()
    """Instrument parameters that the data determine, as used in this estimate."""
    found: FoundInstruments | None = None
    """All instrument parameters of the fit, also those that only priors determine. None: the estimate tells
    nothing of the instruments."""
    common: FloatArray = field(default_factory=lambda: np.zeros((len(PARAMETERS), len(PARAMETERS))))
    """Shape (8, 8), part of ``covariance`` that all estimates with the same given instruments share."""
    gust_rad: float | None = None
    """Standard deviation of the gust angle w/V, rad, where the air moved."""
    filtered: bool = False
    """Whether ``theta`` comes from filter error, which allows for moving air and coloured instruments."""
    servo_lag_s: float = 0.0
    """First-order lag of the servo in use, s, given or estimated."""
    prediction: Mapping[str, float] = field(default_factory=dict)
    """Output name to the largest half-width of the 95 % band of the predicted response, over the peak of that
    response. Empty while a manoeuvre is still being flown."""
    names: tuple[str, ...] = PARAMETERS
    """Names of the parameters."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs in the fit."""
        return tuple(self.fits[0])

    def instrument(self, name: str) -> InstrumentEstimate | None:
        """Return the estimate of one instrument parameter; None where the data do not determine it."""
        return next((x for x in self.instruments if x.name == name), None)

    @property
    def std(self) -> FloatArray:
        """Shape (8,), standard deviations corrected for coloured residuals."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def std_cr(self) -> FloatArray:
        """Shape (8,), plain Cramér-Rao standard deviations."""
        return np.sqrt(np.diag(self.covariance_cr))

    @property
    def own_covariance(self) -> FloatArray:
        """Shape (8, 8), covariance for given instruments, corrected for coloured residuals."""
        return self.covariance - self.common

    @property
    def own_covariance_cr(self) -> FloatArray:
        """Shape (8, 8), plain Cramér-Rao bound for given instruments."""
        return self.covariance_cr - self.common

    def value(self, parameter: str) -> float:
        """Return one parameter by name."""
        return float(self.theta[self.names.index(parameter)])


@dataclass(frozen=True, slots=True)
class NoEstimate:
    """The reason for a missing estimate: a numerical failure is a value, not an exception."""

    code: str
    """``too_few_samples``, ``no_input``, ``not_converged``, ``singular``, ..."""
    text: str
    """The sentence for people."""
