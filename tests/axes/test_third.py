"""A third axis, roll alone, as one table: flown, estimated and diagnosed by the common rooms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from advisor.aircraft.aircraft import Aircraft, SideControl
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.gap.axis.comparison import compare_axis
from advisor.model.axis import CONSTANT, Axis, Known, Read, Term
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import estimate_axis

ROLL = Axis(
    name="roll",
    states=("p", "bank"),
    inputs=("aileron",),
    outputs=("p", "bank"),
    shared=(Term("L_p", "p", "p", 1), Term("L_delta_a", "p", "aileron", 2)),
    constants=(Term("L_0", "p", CONSTANT, 2),),
    turning=(Known("bank", "p", CONSTANT),),
    seen=(Read("p", "p"), Read("bank", "bank")),
    needed=("p", "bank"),
    floor={"p": 5e-4, "bank": 5e-4},
    letters={"L": "p"},
    clocks=("bank",),
    follows={"aileron": ("p", "L_delta_a")},
    words={"p": "roll rate", "bank": "bank angle"},
    inputs_to_fly={"aileron": "an aileron doublet"},
    equations={"rolling_moment": "p"},
    sensors={"roll_rate_sensor": "p", "attitude_sensor": "bank"},
    readings={
        "p": ("roll rate", "pitch_rate_skew", "pitch_rate_sensor"), "bank": ("attitude", "attitude_skew", ""),
    },
    natural_size=lambda theta: {"L_p": abs(theta[0]), "L_delta_a": abs(theta[1])},
)  # fmt: skip
TRUE = {"L_p": -4.0, "L_delta_a": -30.0}
LAG_S = 0.08
T = np.arange(0.0, 12.0, 0.02)


def flown(number: int, sign: float) -> Maneuver:
    """Return a doublet of the aileron, whose servo lags, by an integration of its own."""
    at = [2.0, 2.1, 3.0, 3.1, 4.0, 4.1]
    command = 0.05 * sign * np.interp(T, at, [0.0, 1.0, 1.0, -1.0, -1.0, 0.0])

    def rates(t: float, x: np.ndarray) -> list[float]:
        p, _, moved = x
        return [TRUE["L_p"] * p + TRUE["L_delta_a"] * moved, p, (np.interp(t, T, command) - moved) / LAG_S]

    p, bank, _ = solve_ivp(rates, (0.0, T[-1]), [0.0, 0.02, 0.0], t_eval=T, max_step=0.02, rtol=1e-9).y
    noise = 2e-3 * np.random.default_rng(number).standard_normal((2, len(T)))
    measured = {"aileron": command, "p": p + noise[0], "bank": bank + noise[1], "airspeed": 0.0 * T + 20.0}
    channels = {name: Channel(name, T, y, "test", "measured") for name, y in measured.items()}
    return Maneuver(number, 0, Span(0.0, 2.0, 4.1, T[-1], "aileron doublet", (), "quiet"), channels)


FLIGHT = [flown(number, sign) for number, sign in enumerate((1.0, -1.0, 1.0), start=1)]


def aircraft(lag_s: float, **changed: float) -> Aircraft:
    return Aircraft(model=TRUE | changed, aileron=SideControl(lag_s=lag_s))


@pytest.fixture(scope="module", autouse=True)
def found() -> AxisEstimate:
    """The estimate of the flight, which compiles the motion of two states on a new machine."""
    made = estimate_axis(ROLL, FLIGHT, aircraft(LAG_S))
    assert isinstance(made, AxisEstimate)
    return made


def test_a_third_axis_is_estimated_within_its_errors(found: AxisEstimate) -> None:
    assert np.all(np.abs(found.theta - list(TRUE.values())) < 3.0 * found.std)
    assert np.all(found.std < 0.05 * np.abs(found.theta))
    assert not found.not_identifiable


@pytest.mark.parametrize(
    ("lag_s", "changed", "answer"),
    [(LAG_S, {}, "none"), (LAG_S, {"L_delta_a": -20.0}, "parameters"), (0.02, {}, "aileron_actuator_lag")],
)
def test_a_third_axis_is_diagnosed(lag_s: float, changed: dict[str, float], answer: str) -> None:
    found = compare_axis(ROLL, FLIGHT, aircraft(lag_s, **changed))
    said = found.causes[0].name if found.verdict == "effect" else found.verdict
    assert said == answer
