"""Simulators by their specification: ``linear``, or a kind, a colon and an argument."""

from collections.abc import Callable
from importlib import import_module
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.simulators.by_log import from_log
from advisor.simulators.isolated import Isolated
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Factory, Simulator
from advisor.words.problems import ConfigurationError

_PARTS = 2


def make_python(rest: str, aircraft: Aircraft) -> Simulator:
    """Start a process that imports the module and calls the factory, without arguments.

    Raises
    ------
    ConfigurationError
        ``rest`` is not ``module:factory``, or the module or function does not exist.
    """
    parts = rest.split(":")
    if len(parts) != _PARTS or not all(part.replace(".", "_").isidentifier() for part in parts):
        raise ConfigurationError(
            f"--simulator python:{rest}: name a module and a function, as in python:my_simulator:make."
        )
    return Isolated(rest, description=f"Python {rest}")


GROUP = "inflight_advisor.simulators"
"""Entry points of other packages: a kind, and an ``advisor.simulators.protocol.Factory``."""
_OURS = {
    "jsbsim": "advisor.simulators.jsbsim:make_jsbsim",
    "fmu": "advisor.simulators.fmu:make_fmu",
    "python": "advisor.simulators.specification:make_python",
}
_NEEDS = {"jsbsim": ("jsbsim", "jsbsim"), "fmu": ("fmpy", "fmu")}
"""Required package, and the extra of this project that installs it, for each kind of simulator."""
_FORMS = "linear, jsbsim:MODEL, fmu:FILE, python:module:factory, log:FILE"

ReadLog = Callable[[Path], list[Maneuver]]
"""Function that reads the manoeuvres of a log."""


def simulator_of(specification: str, aircraft: Aircraft, read_log: ReadLog) -> Simulator:
    """Make the simulator that a specification names.

    Parameters
    ----------
    read_log
        Function that reads a log written by the simulator.

    Raises
    ------
    ConfigurationError
        The kind is unknown, its package is missing, or the part after the colon does not exist.
    UnusableInputError
        The log of the simulator cannot be used.
    """
    kind, _, rest = specification.partition(":")
    if kind == "linear":
        return _of_the_file(rest, aircraft)
    others = {point.name: point for point in entry_points(group=GROUP)}
    if kind != "log" and kind not in _OURS and kind not in others:
        kinds = ", ".join([_FORMS, *(f"{name}:..." for name in others)])
        raise ConfigurationError(
            f"--simulator {specification}: {kind!r} is no kind of simulator; give {kinds}."
        )
    if not rest:
        form = next((f for f in _FORMS.split(", ") if f.startswith(kind)), f"{kind}:...")
        raise ConfigurationError(f"--simulator {specification}: nothing follows the colon; write {form}.")
    if kind == "log":
        return from_log(Path(rest), aircraft, read_log)
    _refuse_missing(kind, specification)
    factory: Factory = others[kind].load() if kind in others else _load(_OURS[kind])
    return factory(rest, aircraft)


def _of_the_file(rest: str, aircraft: Aircraft) -> LinearSimulator:
    missing = [name for name in DERIVATIVES if name not in aircraft.model]
    if rest:
        raise ConfigurationError(
            f"--simulator linear:{rest}: linear takes nothing; write --simulator linear."
        )
    if missing:
        raise ConfigurationError(
            f"--simulator linear: the aircraft file's model lacks {', '.join(missing)}; complete `model`."
        )
    return LinearSimulator(
        {name: aircraft.model[name] for name in DERIVATIVES}, aircraft.reference_airspeed_m_s
    )


def _refuse_missing(kind: str, specification: str) -> None:
    package, extra = _NEEDS.get(kind, ("", ""))
    if package and find_spec(package) is None:
        raise ConfigurationError(
            f"--simulator {specification}: the package {package} is not installed; "
            f"install inflight-advisor[{extra}]."
        )


def _load(place: str) -> Factory:
    module, name = place.split(":")
    factory: Factory = getattr(import_module(module), name)
    return factory
