"""One FMU through FMPy, of FMI 2 or FMI 3: loading, initialisation, steps and values."""

import tempfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from advisor.words.problems import UnusableInputError

_REAL = ("Real", "Float64")
Use = Literal["output", "input", "start"]
"""Use of a variable: read, set in every step, or set before the first step."""


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
