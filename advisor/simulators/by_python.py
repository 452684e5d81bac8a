"""A simulator from a Python function: ``python:module:factory``, in a separate process."""

from advisor.aircraft.aircraft import Aircraft
from advisor.simulators.isolated import Isolated
from advisor.simulators.protocol import Simulator
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
