"""Linear surrogate of a simulator: derivatives, and the lag and delay of its own servo."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import Effects, base_entries, variants_for, with_known
from advisor.gap.effects.actuator_lag import LAG
from advisor.gap.effects.transport_delay import DELAY
from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.fitting.regression import regressions
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.simulator.layout import (
    DERIVATIVES,
    HEIGHT,
    INDEX,
    NUISANCES,
    OUTPUTS,
    REFERENCE,
    SPEED,
    THETA_FROM,
)  # fmt: skip
from advisor.process.arrays import FloatArray
from advisor.simulators.increments import trimmed
from advisor.simulators.inputs import on_grid, read_from
from advisor.simulators.protocol import Replay

_STARTS_S = (0.003, 0.03, 0.1)
"""Starting values of the servo's lag and delay, s, because the cost has local minima in a delay."""
_DIGITS = 4
"""Number of decimals of a lag or delay in s. No record shows a tenth of a millisecond."""


@dataclass(frozen=True)
class Surrogate:
    """Linear model of a simulator, with a first-order servo."""

    derivatives: Mapping[str, float]
    """Derivatives Z_alpha, Z_q, Z_delta_e, M_alpha, M_q, M_delta_e at the reference speed."""
    reference_m_s: float
    lag_s: float = 0.0
    """First-order lag of the simulator's own servo, s."""
    delay_s: float = 0.0
    """Delay before the simulator's own servo, s."""

    def aircraft(self, file: Aircraft) -> Aircraft:
        """Return the aircraft file with the surrogate as its model, and with both servos in series."""
        lag_s, delay_s = file.elevator.lag_s, file.elevator.delay_s
        # What neither of the two states stays open.
        elevator = replace(
            file.elevator,
            lag_s=(lag_s or 0.0) + self.lag_s if self.lag_s else lag_s,
            delay_s=(delay_s or 0.0) + self.delay_s if self.delay_s else delay_s,
        )
        given = file.airspeed_m_s or file.reference_airspeed_m_s
        reference = self.reference_m_s if given is None else file.reference_airspeed_m_s or self.reference_m_s
        return replace(
            file, model=dict(self.derivatives), elevator=elevator, reference_airspeed_m_s=reference
        )


def entries_of(flights: PreparedManeuvers, as_file: Aircraft, effects: Effects) -> FloatArray:
    """Return the inputs of a file's model with effects, shape (manoeuvres, entries)."""
    base = with_known(base_entries(as_file), effects, flights, variants_for(flights))
    derivatives = np.array([as_file.model[name] for name in DERIVATIVES])
    still = SearchPoint(derivatives, np.zeros((len(flights), len(NUISANCES))))
    return EffectProblem(flights, base).driving(still)


def surrogate_of(
    flights: PreparedManeuvers,
    flown: Sequence[PreparedManeuver],
    replays: Sequence[Replay],
    command: FloatArray,
    linearised: Mapping[str, float] | None,
) -> Surrogate:
    """Return the surrogate identified by output error from the simulator's own replays.

    Parameters
    ----------
    flown, replays
        Manoeuvres as flown by the simulator (``advisor.simulators.inputs.as_flight``), and the replays.
    command
        Shape (manoeuvres, entries): effects between the recorded command and the simulator's input.
    linearised
        Derivatives of the simulator, at which the search starts; None for a start from a regression.
    """
    # The simulator's four outputs are known without instruments, whichever the flight has measured.
    read = tuple(read_from(f, on_grid(r, f), OUTPUTS) for f, r in zip(flown, replays, strict=True))
    peaks = np.array([float(np.median([np.ptp(f.outputs[c].y) for f in read])) for c in OUTPUTS])
    seen = replace(
        flights, flights=read, channels=OUTPUTS, alpha_is_derived=False, alpha_is_smoothed=False,
        white=1e-3 * peaks, peaks=peaks,
    )  # fmt: skip
    problem = EffectProblem(seen, command, smallest_noise=1e-3 * np.maximum(peaks, 1e-9))
    own = np.zeros((len(read), len(NUISANCES)))
    own[:, NUISANCES.index("Z_trim")] = [
        trimmed_at(p, f)[INDEX["Z_trim"]] for p, f in zip(command, read, strict=True)
    ]
    guesses = [*regressions(seen)]
    if linearised is not None:
        guesses.append(np.array([linearised[name] for name in DERIVATIVES]))
    plain = min((fit(problem, SearchPoint(guess, own)) for guess in guesses), key=_cost)
    late = [
        fit(problem, plain.point.with_effect(DELAY, (delay,)).with_effect(LAG, (lag,)), iterations=20)
        for delay, lag in product(_STARTS_S, _STARTS_S)
    ]
    best = min(late, key=_cost)
    (delay,), (lag,) = best.point.values
    derivatives = dict(zip(DERIVATIVES, map(float, best.point.derivatives), strict=True))
    lag_s, delay_s = (max(round(float(x), _DIGITS), 0.0) for x in (lag, delay))
    return Surrogate(derivatives, flights.reference_m_s, lag_s, delay_s)


def trimmed_at(p: FloatArray, flight: PreparedManeuver) -> FloatArray:
    """Return the simulator inputs, shape (entries,), with a manoeuvre's trim terms at the simulator's
    start."""
    theta, reference = float(flight.trim[THETA_FROM]), float(flight.trim[REFERENCE])
    speed, height = float(flight.slow[SPEED, 0]), float(flight.slow[HEIGHT, 0])
    return trimmed(p, flight.alpha_trim, theta, speed, height, reference)


def _cost(fitted: EffectFit) -> float:
    return fitted.cost if np.isfinite(fitted.cost) else np.inf
