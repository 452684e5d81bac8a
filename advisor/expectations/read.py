"""Reader of an expectations file: YAML to `Expectations`, with every mistake listed at once."""

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS
from advisor.expectations.expected import MODES, SECTIONS, Expectations, Near, Origin
from advisor.expectations.modes import lacking
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.model.mil_f_8785c import CATEGORIES
from advisor.process.yaml_file import read_yaml
from advisor.words.problems import ConfigurationError

_Value = TypeVar("_Value")
_AXES = ("pitch", "lateral")
_TOLERANCES = ("within", "within_percent", "known_to")
_LEVELS = 3
"""Worst level of flying qualities in MIL-F-8785C."""
_MOST_LISTED = 20
"""Largest number of listed mistakes. With more mistakes, a user has repeated the same one."""
_MEND = "To write a first file from a log, type: advisor expect LOG new.yaml --write."


def read_expectations(path: Path, aircraft: Aircraft) -> Expectations:
    """Read an expectations file.

    Parameters
    ----------
    aircraft
        Aircraft whose model states the values of ``of: model``.

    Raises
    ------
    ConfigurationError
        The file cannot be read, or lists every mistake with its path, e.g. ``derivatives.M_q.within``.
    """
    reader = _Reader(path.parent, aircraft)
    expected = reader.read(read_yaml(path, _MEND))
    if reader.mistakes:
        listed = reader.mistakes[:_MOST_LISTED]
        left = len(reader.mistakes) - len(listed)
        raise ConfigurationError(
            f"{path}: {'; '.join([*listed, *([f'and {left} more'] * bool(left))])}. {_MEND}"
        )
    return expected


class _Reader:
    """Reads each section, and collects the mistakes."""

    def __init__(self, folder: Path, aircraft: Aircraft) -> None:
        self.mistakes: list[str] = []
        self._folder, self._aircraft = folder, aircraft

    def read(self, content: Any) -> Expectations:
        """Return the expectations of the file's content."""
        sections = self._known("", content, SECTIONS)
        read: dict[str, Callable[[str, Any], Any]] = {
            "log": self._log,
            "accepted": lambda path, given: self._each(path, given, _AXES, self._count),
            "complete": lambda path, given: self._each(path, given, _AXES, self._count),
            "derivatives": lambda path, given: self._each(
                path, given, (*PARAMETERS, *SIDE_PARAMETERS), self._near
            ),
            "modes": lambda path, given: self._each(path, given, tuple(MODES), self._near),
            "levels": lambda path, given: self._each(path, given, _AXES, self._levels),
            "gap": lambda path, given: self._each(path, given, _AXES, self._gap),
            "longest_pause_s": lambda path, given: self._each(path, given, (), self._above_zero),
            "alarms": self._alarms,
        }
        values = {name: read[name](name, given) for name, given in sections.items()}
        expected = Expectations(**{name: value for name, value in values.items() if value is not None})
        if not self.mistakes and expected == Expectations(log=expected.log):
            self.mistakes.append("file: expects nothing; give at least one of " + ", ".join(SECTIONS[1:]))
        if expected.asks_of_log and "log" not in sections:
            self.mistakes.append("log: is missing, but an expected value refers to a log")
        return expected

    def _known(self, path: str, given: Any, names: Sequence[str]) -> Mapping[str, Any]:
        """Return the known keys of a section that have a value. Without ``names`` every key is known."""
        if given is None:
            return {}
        if not isinstance(given, dict):
            self.mistakes.append(f"{path or 'file'}: must hold keys with values")
            return {}
        present: dict[str, Any] = {}
        for key, value in given.items():
            if names and key not in names:
                near = get_close_matches(str(key), names, 1)
                meant = f"did you mean {near[0]}?" if near else f"the keys are {', '.join(names)}"
                self.mistakes.append(f"{path}{'.' if path else ''}{key}: unknown key ({meant})")
            elif value is not None:
                present[str(key)] = value
        return present

    def _each(
        self, path: str, given: Any, names: Sequence[str], read: Callable[[str, Any], _Value | None]
    ) -> dict[str, _Value]:
        """Return the values of a section by key, as far as they can be read."""
        values = {key: read(f"{path}.{key}", raw) for key, raw in self._known(path, given, names).items()}
        return {key: value for key, value in values.items() if value is not None}

    def _number(self, path: str, given: Any, must: str, allowed: Callable[[float], bool]) -> float | None:
        if (
            isinstance(given, int | float)
            and not isinstance(given, bool)
            and isfinite(given)
            and allowed(given)
        ):
            return float(given)
        self.mistakes.append(f"{path}: must be {must}, is {given!r:.40}")
        return None

    def _gap(self, path: str, given: Any) -> float | None:
        """Return the largest allowed gap; refuse it where no simulator is given."""
        model = self._aircraft.model
        lateral = path.endswith("lateral")
        stated = any(n in model for n in SIDE_PARAMETERS) if lateral else all(n in model for n in DERIVATIVES)
        if self._aircraft.simulator is None and not stated:
            lacks = "the aircraft file gives no simulator of this axis; state model or simulator there"
            self.mistakes.append(f"{path}: {lacks}")
        return self._number(path, given, "a number of at least 0", lambda x: x >= 0.0)

    def _above_zero(self, path: str, given: Any) -> float | None:
        return self._number(path, given, "a number above 0", lambda x: x > 0.0)

    def _count(self, path: str, given: Any) -> int | None:
        number = self._number(path, given, "a whole number of at least 1", lambda x: x >= 1 and x == int(x))
        return None if number is None else int(number)

    def _level(self, path: str, given: Any) -> int | None:
        must = f"a level of 1 to {_LEVELS}"
        number = self._number(path, given, must, lambda x: x in range(1, _LEVELS + 1))
        return None if number is None else int(number)

    def _levels(self, path: str, given: Any) -> dict[str, int] | None:
        """Return the worst allowed level by category; one number holds for every category."""
        if isinstance(given, dict):
            return self._each(path, given, tuple(CATEGORIES), self._level)
        level = self._level(path, given)
        return None if level is None else dict.fromkeys(CATEGORIES, level)

    def _alarms(self, path: str, given: Any) -> int | None:
        must = "a whole number of at least 0"
        number = self._number(path, given, must, lambda x: x >= 0 and x == int(x))
        return None if number is None else int(number)

    def _log(self, path: str, given: Any) -> Path | None:
        if not isinstance(given, str):
            self.mistakes.append(f"{path}: must be the path of a log, is {given!r:.40}")
            return None
        log = self._folder / given
        if not log.is_file():
            self.mistakes.append(f"{path}: there is no file {log}")
        return log

    def _near(self, path: str, given: Any) -> Near | None:
        keys = self._known(path, given, ("of", *_TOLERANCES))
        within, percent, known_to = (
            self._above_zero(f"{path}.{name}", keys[name]) if name in keys else None for name in _TOLERANCES
        )
        if isinstance(given, dict) and not any(name in keys for name in _TOLERANCES):
            self.mistakes.append(f"{path}: needs a tolerance: {', '.join(_TOLERANCES)}")
        of, value = keys.get("of"), None
        origin: Origin = "number"
        if of == "model" or of == "log":
            origin = of
        elif of is not None:
            value = self._number(f"{path}.of", of, "a number, model, or log", lambda _: True)
        elif "within" in keys or "within_percent" in keys:
            self.mistakes.append(f"{path}.of: is missing: give a number, model, or log")
        if origin == "model":
            self._stated(path)
        if value == 0.0 and percent is not None and within is None:
            self.mistakes.append(
                f"{path}.within_percent: gives no tolerance for an expected value of 0; give within"
            )
        return Near(origin=origin, value=value, within=within, within_percent=percent, known_to=known_to)

    def _stated(self, path: str) -> None:
        """Refuse a value of the model where the aircraft file's model lacks that value."""
        section, name = path.split(".")
        if section == "derivatives" and name not in self._aircraft.model:
            self.mistakes.append(
                f"{path}.of: the aircraft file's model has no {name}; name it there (--aircraft)"
            )
        if section == "modes" and (missing := lacking(self._aircraft.model, name)):
            self.mistakes.append(
                f"{path}.of: the aircraft file's model has no {' '.join(missing)} (--aircraft)"
            )
