"""Comparison of a flight with a functional mock-up unit (FMI 2 or 3): ``fmu:FILE.fmu``.

An FMU is a program. The FMU runs in a separate process, with a time limit and the user's rights.
"""

import importlib.util
import math
import tempfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import FmuVariables
from advisor.simulators.isolated import Isolated
from advisor.simulators.protocol import CONDITIONS, CONTROLS, Condition
from advisor.simulators.stepped import Stepping
from advisor.words.problems import ConfigurationError, UnusableInputError

_STEP_S = 0.01
_ANGULAR = (
    "elevator", "aileron", "rudder", "alpha", "q", "theta", "force_increment", "moment_increment", "bank",
    "r", "p", "beta",
)  # fmt: skip
_OUTPUTS = ("alpha", "q", "theta", "a_z", "airspeed", "height", "bank", "r", "p", "a_y", "beta")
_INPUTS = ("elevator", "aileron", "rudder", "throttle", "force_increment", "moment_increment")
_SERIES = {"airspeed": "airspeed_m_s", "height": "height_m"}
_INCREMENTS = {"force": "force_increment", "moment": "moment_increment"}
_TRIM = ("airspeed", "height", "flight_path", "mass", "wind_along", "wind_right", "alpha", "theta")
_REAL = ("Real", "Float64")
Use = Literal["output", "input", "start"]
"""Use of a variable: read, set in every step, or set before the first step."""


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


class FmuSimulator(Stepping):
    """An FMU that flies recorded inputs (a simulator of the protocol).

    Inputs are held over each communication step at their mean. Increments are those of the state in the
    middle of the step, extrapolated by the last step's rates.

    Parameters
    ----------
    speed_tolerance_percent : float
        Largest difference between the FMU's initial air speed and the flown air speed.
    """

    _trim_fix = (
        "Check fmu.trim of the aircraft file, or leave fmu.trim.alpha out where the FMU begins trimmed."
    )

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
        self._dt = variables.step_s or self._fmu.default_step_s or _STEP_S
        self.takes_increments = variables.force_increment is not None
        conditions = {name for name in CONDITIONS if any(key.startswith(name) for key in self._trim)}
        self.takes = frozenset({*self._inputs} & {*CONTROLS} | conditions)

    def _references(self, variables: FmuVariables, names: tuple[str, ...], use: Use) -> dict[str, int]:
        return {
            name: self._fmu.reference(f"fmu.{name}", variable, use)
            for name in names
            if (variable := getattr(variables, name)) is not None
        }

    def _begin(self, condition: Condition) -> dict[str, float]:
        trim = self._trimmed(condition) if "alpha" in self._trim else {}
        self._start(condition, trim)
        names = [name for name in self._inputs if name in ("elevator", *CONTROLS)]
        values = zip(names, self._fmu.read([self._inputs[name] for name in names]), strict=True)
        rest = {name: self._factor[name] * value for name, value in values}
        self._check_speed(condition)
        return {**rest, **{name: value for name, value in trim.items() if name != "alpha"}}

    def _start(self, condition: Condition, trim: Mapping[str, float]) -> None:
        flown = {
            "airspeed": condition.airspeed_m_s / self._factor["airspeed"],
            "height": condition.height_m / self._factor["height"],
            "flight_path": condition.flight_path_rad / self._angle,
            "mass": condition.mass_kg,
            "wind_along": condition.wind_m_s[0],
            "wind_right": condition.wind_m_s[1],
        }
        if trim:
            flown["alpha"] = trim["alpha"] / self._factor["alpha"]
            flown["theta"] = (condition.flight_path_rad + trim["alpha"]) / self._factor["theta"]
        values = {self._trim[n]: v for n, v in flown.items() if n in self._trim and v is not None}
        if trim:
            values[self._inputs["elevator"]] = trim["elevator"] / self._factor["elevator"]
        self._fmu.begin(values)
        self._steps = 0

    def _step(self, controls: Mapping[str, float]) -> None:
        sent = {_INCREMENTS.get(name, name): value for name, value in controls.items()}
        self._fmu.write({self._inputs[name]: value / self._factor[name] for name, value in sent.items()})
        self._fmu.step(self._steps * self._dt, self._dt)
        self._steps += 1

    def _seen(self, condition: Condition) -> Mapping[str, float]:
        """Return the outputs; unmapped speed and height are the condition's."""
        values = zip(self._outputs, self._fmu.read(self._outputs.values()), strict=True)
        motion = {_SERIES.get(name, name): self._factor[name] * value for name, value in values}
        return {"airspeed_m_s": condition.airspeed_m_s, "height_m": condition.height_m, **motion}

    def _end(self) -> None:
        self._fmu.end()

    def _check_speed(self, condition: Condition) -> None:
        began = self._seen(condition)["airspeed_m_s"]
        if abs(began / condition.airspeed_m_s - 1.0) > self._tolerance:
            raise UnusableInputError(
                "simulator_trim",
                f"{self.description} begins at {began:.4g} m/s, but the flight was flown at"
                f" {condition.airspeed_m_s:.4g} m/s.",
                "Name the parameter of its initial air speed in fmu.trim.airspeed of the aircraft file.",
            )


class Fmu:
    """An FMU for co-simulation, unpacked into the temporary folder of this process.

    Raises
    ------
    UnusableInputError
        The file is no FMU of FMI 2 or 3, is for no co-simulation, or has no binary for this platform. The
        other methods raise it for a missing variable, a value that is no number, or a refused call.
    """

    def __init__(self, path: Path) -> None:
        import fmpy

        self.name = path.name
        try:
            self._description: Any = fmpy.read_model_description(str(path), validate=False)
            platforms = fmpy.supported_platforms(str(path))
            self._folder = fmpy.extract(str(path), tempfile.mkdtemp())
        except Exception as error:
            # FMPy passes on the exceptions of zip files, of XML and its own, down to Exception itself.
            raise self._unusable(f"is no FMU: {_sentence(error)}", "Export the FMU again.") from error
        version = self._description.fmiVersion
        if not version.startswith(("2.", "3.")):
            raise self._unusable(f"is of FMI {version}", "Export it as FMI 2 or FMI 3.")
        if self._description.coSimulation is None:
            raise self._unusable("is for no co-simulation", "Export it for co-simulation, with its solver.")
        if fmpy.platform not in platforms and fmpy.platform_tuple not in platforms:
            has = ", ".join(platforms) or "none"
            raise self._unusable(
                f"has no binary for {fmpy.platform_tuple}; it has: {has}",
                "Export it on this platform, or compile its sources.",
            )
        self._is_fmi3 = version.startswith("3.")
        self._variables = {variable.name: variable for variable in self._description.modelVariables}
        self._instance: Any = None

    @property
    def default_step_s(self) -> float | None:
        """Step that the FMU proposes, s; None without a proposal."""
        experiment = self._description.defaultExperiment
        step = None if experiment is None else experiment.stepSize
        return None if step is None else float(step)

    def reference(self, key: str, variable: str, use: Use) -> int:
        """Return the value reference of a variable that the aircraft file's ``key`` names."""
        described = self._variables.get(variable)
        if described is None:
            raise self._unusable(
                f"has no variable {variable!r}, which {key} of the aircraft file names",
                f"Correct {key}; the model description of the FMU lists the names.",
            )
        if described.type not in _REAL or described.dimensions:
            raise self._unusable(
                f"has {variable!r}, which {key} names, but that is {described.type}, not one real number",
                f"Name a real variable in {key}.",
            )
        if not _allows(described, use):
            raise self._unusable(
                f"has {variable!r}, which {key} names, as {described.causality}, which cannot be set",
                f"Name an input or a parameter in {key}, or make that variable one.",
            )
        return int(described.valueReference)

    def begin(self, start: Mapping[int, float]) -> None:
        """Instantiate the FMU, set start values, and leave it ready for the first step."""
        from fmpy.simulation import instantiate_fmu

        self.end()
        try:
            instance = instantiate_fmu(self._folder, self._description, fmi_type="CoSimulation")
            self._instance = instance
            if not self._is_fmi3:
                instance.setupExperiment(startTime=0.0)
            self.write(start)
            instance.enterInitializationMode()
            instance.exitInitializationMode()
        except UnusableInputError:
            raise
        except Exception as error:
            raise self._refused("at its start", error) from error

    def write(self, values: Mapping[int, float]) -> None:
        """Set real variables by value reference."""
        if not values:
            return
        setter = self._instance.setFloat64 if self._is_fmi3 else self._instance.setReal
        try:
            setter(list(values), [float(value) for value in values.values()])
        except Exception as error:
            raise self._refused("while a value was set", error) from error

    def read(self, references: Iterable[int]) -> list[float]:
        """Return the values of real variables by value reference."""
        getter = self._instance.getFloat64 if self._is_fmi3 else self._instance.getReal
        try:
            return [float(value) for value in getter(list(references))]
        except Exception as error:
            raise self._refused("where its variables are read", error) from error

    def step(self, t: float, width: float) -> None:
        """Advance the FMU from ``t`` by ``width`` seconds."""
        try:
            ended = self._instance.doStep(t, width)
        except Exception as error:
            raise self._refused(f"at {t:.2f} s", error) from error
        if self._is_fmi3 and ended[1]:
            raise self._unusable(f"ends its simulation at {t:.2f} s", "Let it run as long as a manoeuvre.")

    def end(self) -> None:
        """Free the FMU's instance, if any."""
        if self._instance is None:
            return
        instance, self._instance = self._instance, None
        # An FMU that refused a step may refuse to end, too.
        with suppress(Exception):
            instance.terminate()
        with suppress(Exception):
            instance.freeInstance()

    def _refused(self, when: str, error: Exception) -> UnusableInputError:
        return self._unusable(
            f"fails {when}: {_sentence(error)}", "Run the FMU by itself with the same start values."
        )

    def _unusable(self, what: str, mend: str) -> UnusableInputError:
        return UnusableInputError("simulator_fmu", f"{self.name} {what}.", mend)


def _allows(variable: Any, use: Use) -> bool:
    if use == "output" or variable.causality == "input":
        return True
    if use == "start":
        # A state of a Modelica model is no parameter, but its start value is set like one.
        return bool(variable.causality == "parameter" or variable.initial in ("exact", "approx"))
    return bool(variable.causality == "parameter" and variable.variability == "tunable")


def _sentence(error: Exception) -> str:
    return " ".join(str(error).split())[:300].rstrip(". ") or type(error).__name__
