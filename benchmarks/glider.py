"""A real motor glider against the simulator that its builders used beforehand, in two codings.

    python -m benchmarks.glider FOLDER [--coding NAME ...]

FOLDER holds ``glider.tlog`` and ``glider.yaml``. The aircraft has about half of the simulator's moment
stiffness, and its servo is late. Every coding is compared with all manoeuvres and with each half of them. A
row has the first cause and its size, the 95 % interval of C_m_alpha, and the shrink of the pitch rate's error
in the other half. The benchmark itself measures the shrink: its own replay flies the coefficients and the
lateness that a half has found.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.gap_flights import maneuvers_of, without_refused
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.track import standard_density, standard_pressure
from advisor.oem.lag import lagged
from advisor.process.arrays import FloatArray
from advisor.simulators.compare import Compared, compare
from advisor.simulators.protocol import Condition, Increments, Inputs, Replay, Simulator, State
from advisor.simulators.stepped import Stepped
from benchmarks.halves import halves_of

MASS_KG, AREA_M2, CHORD_M, IYY_KG_M2 = 3.1, 0.61681, 0.16725, 0.2487
CL_0, CD_0, INDUCED = 0.3, 0.03, 0.018
HEIGHT_M = 500.0
"""Assumed height of the record, m, because its positions were not handed on."""
_STEP_S = 0.005


@dataclass(frozen=True)
class Glider:
    """The simulator, coded as one function that integrates by the midpoint rule."""

    cl_alpha: float = 5.77
    cm_alpha: float = -1.30
    cm_q: float = -13.6
    cm_elevator: float = -1.07
    description: str = "the glider's simulator"
    takes_increments: bool = True
    takes: frozenset[str] = frozenset()
    speed_limit_s: float = 60.0

    def rates(
        self, x: Sequence[float], elevator: float, thrust: float, balance: float
    ) -> tuple[FloatArray, float, float]:
        """Return the rates of α, q, θ, V and h, and the specific forces along x and z.

        ``thrust`` is that over the mass, ``balance`` the moment coefficient of the trim.
        """
        alpha, q, theta, speed, height = x
        dynamic = 0.5 * float(standard_density(standard_pressure(height))) * speed**2 * AREA_M2
        cl = CL_0 + self.cl_alpha * alpha
        lift, drag = dynamic * cl / MASS_KG, dynamic * (CD_0 + INDUCED * cl**2) / MASS_KG
        turn = self.cm_q * q * CHORD_M / speed
        moment = balance + self.cm_alpha * alpha + turn + self.cm_elevator * elevator
        c, s, path = np.cos(alpha), np.sin(alpha), theta - alpha
        found = [
            q - (lift + thrust * s - GRAVITY_M_S2 * np.cos(path)) / speed,
            dynamic * CHORD_M / IYY_KG_M2 * moment,
            q,
            thrust * c - drag - GRAVITY_M_S2 * np.sin(path),
            speed * np.sin(path),
        ]
        return np.array(found), thrust - drag * c + lift * s, -lift * c - drag * s

    def trimmed(self, at: Condition) -> tuple[FloatArray, float, float]:
        """Return the state, the thrust over the mass and the moment coefficient of steady flight."""
        alpha = thrust = 0.0
        for _ in range(50):
            x = np.array([alpha, 0.0, at.flight_path_rad + alpha, at.airspeed_m_s, at.height_m])
            now, _, _ = self.rates(x.tolist(), 0.0, thrust, 0.0)
            thrust -= float(now[3])
            pressure = 0.5 * float(standard_density(standard_pressure(at.height_m))) * at.airspeed_m_s
            alpha += float(now[0]) * MASS_KG / (pressure * AREA_M2 * self.cl_alpha)
        return x, thrust, -self.cm_alpha * float(x[0])

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Trim, and fly the inputs."""
        x, thrust, balance = self.trimmed(condition)
        t = np.arange(0.0, inputs.t[-1] + 1.5 * _STEP_S, _STEP_S)
        ends, middles = (np.interp(at, inputs.t, inputs.elevator) for at in (t, t + 0.5 * _STEP_S))

        def flown(y: FloatArray, elevator: float, at: float) -> tuple[FloatArray, float, float]:
            found, a_x, a_z = self.rates(y.tolist(), elevator, thrust, balance)
            if increments is not None:
                state = State(at, y[0], found[0], y[1], elevator, y[3], y[4], 0.0)
                force, turn = increments(state)
                found, a_z = found + np.array([force, turn, 0.0, 0.0, 0.0]), a_z + force * y[3]
            return found, a_x, a_z

        rows = []
        for at, end, middle in zip(t.tolist(), ends.tolist(), middles.tolist(), strict=True):
            found, a_x, a_z = flown(x, end, at)
            rows.append([*x, a_z, a_x])
            x = x + _STEP_S * flown(x + 0.5 * _STEP_S * found, middle, at)[0]
        alpha, q, theta, speed, height, down, along = np.array(rows).T
        return Replay(t, alpha, q, theta, down, speed, height, along)

    def linearise(self, condition: Condition) -> None:
        """Hand nothing out."""

    def close(self) -> None:
        """Do nothing: no process runs."""


class Stepping:
    """The simulator, coded as an environment that steps by Euler's method and knows no trim."""

    def reset(self, speed: float, height: float, alpha: float, theta: float) -> None:
        """Begin with thrust that balances drag and weight along the path."""
        self.x = np.array([alpha, 0.0, theta, speed, height])
        rates, _, self.a_z = Glider().rates(self.x.tolist(), 0.0, 0.0, 0.0)
        self.thrust = -float(rates[3]) / np.cos(alpha)

    def step(self, dt: float, elevator: float) -> None:
        """Advance in twenty parts."""
        for _ in range(20):
            rates, _, self.a_z = Glider().rates(self.x.tolist(), elevator, self.thrust, 0.0)
            self.x = self.x + dt / 20.0 * rates

    def observe(self) -> dict[str, float]:
        """Return the motion."""
        names = ("alpha", "q", "theta", "airspeed", "height")
        return {**dict(zip(names, map(float, self.x), strict=True)), "a_z": float(self.a_z)}


CODINGS: Mapping[str, Callable[[], Simulator]] = {
    "function": Glider,
    "stepping": lambda: Stepped(Stepping(), "the glider's environment"),
}


def improved(told: Compared) -> Glider:
    """Return the simulator with the coefficients that a comparison has found."""
    as_filed, found, plain = told.aircraft.model, told.diagnosis.model, Glider()
    share = {name: found[name].value / as_filed[name] for name in as_filed if as_filed[name]}
    return Glider(
        plain.cl_alpha * share["Z_alpha"], plain.cm_alpha * share["M_alpha"],
        plain.cm_q * share["M_q"], plain.cm_elevator * share["M_delta_e"],
    )  # fmt: skip


def pitch_rate_error(m: Maneuver, simulator: Glider, effects: Mapping[str, Mapping[str, float]]) -> float:
    """Return the sum of the squared errors of the pitch rate, (rad/s)², without their mean, which an error of
    the trim causes."""

    def steady(name: str) -> float:
        channel = m.channels[name]
        return float(np.mean(channel.y[channel.t < m.span.start_s]))

    speed = steady("airspeed")
    condition = Condition(speed, HEIGHT_M, float(np.arcsin(steady("climb_rate") / speed)))
    sizes = {name: next(iter(values.values())) for name, values in effects.items()}
    elevator, q = m.channels["elevator"], m.channels["q"]
    t = np.arange(0.5 * _STEP_S, q.t[-1] - m.span.record_from_s, _STEP_S)
    at = t + m.span.record_from_s - sizes.get("transport_delay", 0.0)
    u = np.interp(at, elevator.t, elevator.y) - steady("elevator")
    if lag_s := sizes.get("actuator_lag"):
        u = lagged(np.full(len(u) - 1, _STEP_S), u[:-1], u[1:], lag_s, float(u[0]))
    flown = simulator.replay(condition, Inputs(t, u))
    seen = q.t - m.span.record_from_s - sizes.get("pitch_rate_skew", 0.0)
    missed = q.y - np.interp(seen, flown.t, flown.q)
    return float(np.sum((missed - np.mean(missed)) ** 2))


def row(coding: str, what: str, told: Compared, others: Sequence[Maneuver]) -> str:
    """Return one row of the table."""
    d = told.diagnosis
    first = next((c for c in d.causes if c.present), None)
    size = "" if first is None else f"{next(iter(first.parameters.values())).value:.3f}"
    per_unit = Glider().cm_alpha / told.aircraft.model["M_alpha"]
    stiffness, error = (x * per_unit for x in (d.model["M_alpha"].value, 1.96 * d.model["M_alpha"].std))
    plain, better = (
        sum(pitch_rate_error(m, simulator, effects) for m in others)
        for simulator, effects in ((Glider(), {}), (improved(told), d.effects))
    )
    shrink = f"{100.0 * (1.0 - better / plain):.0f}" if others else ""
    named = d.verdict if first is None else f"{first.effect}, P {first.probability:.2f} ({d.verdict})"
    cells = coding, what, named, size, f"{stiffness:.2f} ± {error:.2f}", shrink
    return f"| {' | '.join(cells)} |"


@click.command
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--coding", "codings", multiple=True, type=click.Choice(list(CODINGS)), help="Only these.")
def main(folder: Path, codings: tuple[str, ...]) -> None:
    """Compare the glider's record with its simulator."""
    file = load_aircraft(folder / "glider.yaml")
    aircraft = replace(file, reference=replace(file.reference, height_m=HEIGHT_M))
    flown = maneuvers_of([folder / "glider.tlog"], aircraft).maneuvers
    usable = without_refused(flown, aircraft).maneuvers
    first, second = halves_of(usable)
    click.echo("| coding | manoeuvres | first cause | size | C_m_alpha | q shrinks in the other half, % |")
    click.echo("|---|---|---|---|---|---|")
    for coding in codings or CODINGS:
        for what, some, others in (
            ("all", usable, []), ("first half", first, second), ("second half", second, first),
        ):  # fmt: skip
            told = compare(some, CODINGS[coding](), aircraft)
            click.echo(row(coding, what, told, others))


if __name__ == "__main__":
    main()
