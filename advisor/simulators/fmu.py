"""Comparison of a flight with a functional mock-up unit (FMI 2 or 3): ``fmu:FILE.fmu``.

An FMU is a program. The FMU runs in a separate process, with a time limit and the user's rights.
"""

import importlib.util
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import FmuVariables
from advisor.process.arrays import FloatArray
from advisor.simulators.fmu_instance import Fmu, Use
from advisor.simulators.isolated import Isolated
from advisor.simulators.protocol import CONDITIONS, CONTROLS, Condition, Increments, Inputs, Replay
from advisor.simulators.steady import midway, steady
from advisor.words.problems import ConfigurationError, UnusableInputError

_STEP_S = 0.01
_ANGULAR = (
    "elevator", "aileron", "rudder", "alpha", "q", "theta", "force_increment", "moment_increment", "bank",
    "r", "p", "beta",
)  # fmt: skip
_MOTION = ("alpha", "q", "theta", "a_z", "airspeed", "height")
_SIDE = ("bank", "r", "p", "a_y", "beta")
_OUTPUTS = (*_MOTION, *_SIDE)
_INPUTS = ("elevator", "aileron", "rudder", "throttle", "force_increment", "moment_increment")
_TRIM = ("airspeed", "height", "flight_path", "mass", "wind_along", "wind_right", "alpha", "theta")


def make_fmu(file: str, aircraft: Aircraft) -> Isolated:
    """Return the simulator of ``fmu:FILE.fmu``, in a separate process.

    Raises
    ------
    ConfigurationError
        FMPy is not installed, the file or a variable does not exist, or the FMU does not run on this
        platform.
    """
    path = Path(file)
    if not path.is_file():
        raise UnusableInputError("no_such_file", f"There is no file {file}.", "Give the path of an .fmu.")
    if aircraft.fmu is None:
        raise ConfigurationError(
            f"fmu: the aircraft file does not say what {path.name} calls its variables: add a section fmu:"
            " with elevator, alpha, q, theta and a_z."
        )
    if importlib.util.find_spec("fmpy") is None:
        raise ConfigurationError("FMPy is not installed: pip install 'inflight-advisor[fmu]'.")
    return Isolated(
        "advisor.simulators.fmu:FmuSimulator",
        path.resolve(),
        aircraft.fmu,
        aircraft.limits.airspeed_change_percent,
        description=f"FMU {path.name}",
    )


class FmuSimulator:
    """An FMU that flies recorded inputs (a simulator of the protocol).

    Inputs are held over each communication step at their mean. Increments are those of the state in the
    middle of the step, extrapolated by the last step's rates.

    Parameters
    ----------
    speed_tolerance_percent : float
        Largest difference between the FMU's initial air speed and the flown air speed.
    """

    speed_limit_s = 20.0

    def __init__(self, path: Path, variables: FmuVariables, speed_tolerance_percent: float) -> None:
        self.description = f"FMU {path.name}"
        self._tolerance = speed_tolerance_percent / 100.0
        self._fmu = Fmu(path)
        self._inputs = self._references(variables, _INPUTS, "input")
        self._outputs = self._references(variables, _OUTPUTS, "output")
        self._trim = {
            name: self._fmu.reference(f"fmu.trim.{name}", variable, "start")
            for name in _TRIM
            if (variable := getattr(variables.trim, name)) is not None
        }
        angle = math.radians(1.0) if variables.units == "deg" else 1.0
        self._factor = {
            name: variables.scale.get(name, 1.0) * (angle if name in _ANGULAR else 1.0)
            for name in (*_INPUTS, *_OUTPUTS)
        }
        self._angle = angle
        self._step_s = variables.step_s or self._fmu.default_step_s or _STEP_S
        self.takes_increments = variables.force_increment is not None
        conditions = {name for name in CONDITIONS if any(key.startswith(name) for key in self._trim)}
        self.takes = frozenset({*self._inputs} & {*CONTROLS} | conditions)

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Start at the condition, and fly the inputs as deviations from their initial values."""
        step = self._step_s
        t = step * np.arange(math.ceil(inputs.t[-1] / step) + 1)
        middles = t[:-1] + 0.5 * step
        given = {"elevator": inputs.elevator, **inputs.others}
        held = {
            name: np.interp(middles, inputs.t, values)
            for name, values in given.items()
            if name in self._inputs
        }
        rest = self._begin(condition, held)
        still = np.zeros(middles.size)
        rows = [self._motion(condition)]
        self._check_speed(condition, rows[0])
        for k, now in enumerate(middles):
            commands = {name: rest[name] + values[k] for name, values in held.items()}
            if increments is not None and self.takes_increments:
                state = midway(rows, now, step, held["elevator"][k], held.get("throttle", still)[k])
                commands["force_increment"], commands["moment_increment"] = increments(state)
            self._command(commands)
            self._fmu.step(float(t[k]), step)
            rows.append(self._motion(condition))
        self._fmu.end()
        side = (name for name in _SIDE if name in self._outputs)
        names = ("alpha", "q", "theta", "a_z", "airspeed_m_s", "height_m", *side)
        seen = dict(zip(names, np.array(rows).T, strict=True))
        return Replay(t, **seen, trim={name: rest[name] for name in held})

    def linearise(self, condition: Condition) -> Mapping[str, float] | None:
        """Return None, because an FMU's states are not generally those of a short period."""
        return None

    def close(self) -> None:
        """Free the FMU's resources."""
        self._fmu.end()

    def _references(self, variables: FmuVariables, names: tuple[str, ...], use: Use) -> dict[str, int]:
        return {
            name: self._fmu.reference(f"fmu.{name}", variable, use)
            for name in names
            if (variable := getattr(variables, name)) is not None
        }

    def _begin(self, condition: Condition, held: Mapping[str, FloatArray]) -> dict[str, float]:
        """Start in steady flight, and return the initial values of the inputs."""
        start = self._start_values(condition)
        if "alpha" not in self._trim:
            self._fmu.begin(start)
            return self._at_rest(held)
        alpha, elevator = self._steady(condition, start)
        self._start_at(condition, start, alpha, elevator)
        return {**self._at_rest(held), "elevator": elevator}

    def _at_rest(self, held: Mapping[str, FloatArray]) -> dict[str, float]:
        values = self._fmu.read([self._inputs[name] for name in held])
        return {name: self._factor[name] * value for name, value in zip(held, values, strict=True)}

    def _start_values(self, condition: Condition) -> dict[int, float]:
        flown = {
            "airspeed": condition.airspeed_m_s / self._factor["airspeed"],
            "height": condition.height_m / self._factor["height"],
            "flight_path": condition.flight_path_rad / self._angle,
            "mass": condition.mass_kg,
            "wind_along": condition.wind_m_s[0],
            "wind_right": condition.wind_m_s[1],
        }
        return {
            self._trim[name]: value
            for name, value in flown.items()
            if name in self._trim and value is not None
        }

    def _start_at(
        self, condition: Condition, start: Mapping[int, float], alpha: float, elevator: float
    ) -> None:
        values = {
            **start,
            self._trim["alpha"]: alpha / self._factor["alpha"],
            self._inputs["elevator"]: elevator / self._factor["elevator"],
        }
        if "theta" in self._trim:
            values[self._trim["theta"]] = (condition.flight_path_rad + alpha) / self._factor["theta"]
        self._fmu.begin(values)

    def _steady(self, condition: Condition, start: Mapping[int, float]) -> tuple[float, float]:
        """Return α and elevator for which neither α nor q changes in the first step (Newton's method)."""

        def change(at: FloatArray) -> FloatArray:
            self._start_at(condition, start, float(at[0]), float(at[1]))
            before = self._motion(condition)
            self._fmu.step(0.0, self._step_s)
            after = self._motion(condition)
            return np.array([after[0] - before[0], after[1] - before[1]]) / self._step_s

        trim = steady(change, np.zeros(2))
        if trim is not None:
            return float(trim[0]), float(trim[1])
        raise UnusableInputError(
            "simulator_trim",
            f"{self.description} finds no steady flight at {condition.airspeed_m_s:.4g} m/s"
            f" and {condition.height_m:.4g} m.",
            "Check fmu.trim of the aircraft file, or leave fmu.trim.alpha out where the FMU begins trimmed.",
        )

    def _command(self, values: Mapping[str, float]) -> None:
        self._fmu.write({self._inputs[name]: value / self._factor[name] for name, value in values.items()})

    def _motion(self, condition: Condition) -> list[float]:
        """Return outputs in the order of ``_OUTPUTS``; unmapped speed and height are the condition's."""
        values = dict(zip(self._outputs, self._fmu.read(self._outputs.values()), strict=True))
        kept = {"airspeed": condition.airspeed_m_s, "height": condition.height_m}
        motion = {name: self._factor[name] * value for name, value in values.items()}
        return [motion.get(name, kept.get(name, np.nan)) for name in _OUTPUTS if name in {*_MOTION, *motion}]

    def _check_speed(self, condition: Condition, row: list[float]) -> None:
        began = row[_OUTPUTS.index("airspeed")]
        if abs(began / condition.airspeed_m_s - 1.0) > self._tolerance:
            raise UnusableInputError(
                "simulator_trim",
                f"{self.description} begins at {began:.4g} m/s, but the flight was flown at"
                f" {condition.airspeed_m_s:.4g} m/s.",
                "Name the parameter of its initial air speed in fmu.trim.airspeed of the aircraft file.",
            )
