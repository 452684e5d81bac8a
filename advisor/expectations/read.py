"""Expectations on a flight, and their reader: YAML to `Expectations`, with every mistake listed at once."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.model.axes.lateral import Trim, modes_of, state_matrix
from advisor.model.mil_f_8785c import CATEGORIES, Category
from advisor.model.short_period import ShortPeriod
from advisor.process.settings_file import must, read_settings, resembling, strict
from advisor.report.qualities import OPTIONAL
from advisor.words.axes import AxisName
from advisor.words.problems import ConfigurationError

_OF_PITCH = ("Z_alpha", "M_alpha", "M_q")
"""Derivatives without which a model has no short period. A Z_q that the file does not state is zero."""


def lacking(model: Mapping[str, float], mode: str) -> tuple[str, ...]:
    """Return the derivatives that a model lacks for a mode; empty for a sufficient model."""
    states_only = [name for name in SIDE_PARAMETERS if "delta" not in name and name not in OPTIONAL]
    needed = _OF_PITCH if mode.startswith("short_period") else states_only
    return tuple(name for name in needed if name not in model)


def mode_of(model: Mapping[str, float], mode: str, trim: Trim | None) -> float | None:
    """Return a mode of a sufficient model, SI; None for a mode that the model does not have.

    Parameters
    ----------
    model
        Derivatives by name, at the reference air speed.
    mode
        Key of ``MODES``.
    trim
        Steady flight of the lateral manoeuvres; None if none was flown.
    """
    if mode.startswith("short_period"):
        short = ShortPeriod.from_mapping(model)
        omega = short.natural_frequency
        number = omega if mode.endswith("omega") else -float(np.trace(short.a)) / (2.0 * omega)
        return number if np.isfinite(number) else None
    if trim is None:
        return None
    theta = np.array([model.get(name, 0.0) for name in SIDE_PARAMETERS])
    modes = modes_of(state_matrix(theta, trim))
    if mode == "spiral_pole":
        return modes.spiral
    if mode == "roll_time_constant":
        return -1.0 / modes.roll if modes.roll else None
    if modes.dutch_roll is None:
        return None
    omega = abs(modes.dutch_roll)
    return omega if mode == "dutch_roll_omega" else -modes.dutch_roll.real / omega


Origin = Literal["number", "model", "log"]
"""Source of an expected value: the expectations file, the aircraft file's model, or another log."""
SECTIONS = (
    "log", "accepted", "complete", "derivatives", "modes", "levels", "gap", "longest_pause_s", "alarms"
)  # fmt: skip
"""Keys of an expectations file."""
MODES: Mapping[str, str] = MappingProxyType(
    {
        "short_period_omega": "rad/s", "short_period_zeta": "", "dutch_roll_omega": "rad/s",
        "dutch_roll_zeta": "", "roll_time_constant": "s", "spiral_pole": "1/s",
    }
)  # fmt: skip
"""Unit of each mode's number, by its key in the section ``modes``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Near:
    """Expected value of a derivative or of a mode, with its tolerance. At least one of the tolerances is
    given."""

    origin: Origin = "number"
    value: float | None = None
    """Expected value, SI; None where another file states the value."""
    within: float | None = None
    """Largest allowed difference from the expected value, SI."""
    within_percent: float | None = None
    """Largest allowed difference from the expected value, % of the expected value."""
    known_to: float | None = None
    """Largest allowed half-width of the 95 % interval, SI."""

    def tolerance(self, value: float) -> float | None:
        """Return the largest allowed difference from an expected value, SI; None without a tolerance.

        Where both tolerances are given, the larger one counts.
        """
        share = None if self.within_percent is None else abs(value) * self.within_percent / 100.0
        allowed = [limit for limit in (self.within, share) if limit is not None]
        return max(allowed) if allowed else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Expectations:
    """Expectations of one flight. An empty section expects nothing."""

    log: Path | None = None
    """Log whose estimates are the expected values of ``of: log``."""
    accepted: Mapping[AxisName, int] = field(default_factory=dict)
    """Least number of accepted manoeuvres, by axis."""
    complete: Mapping[AxisName, int] = field(default_factory=dict)
    """Number of the manoeuvre by which the flight test is complete, by axis."""
    derivatives: Mapping[str, Near] = field(default_factory=dict)
    modes: Mapping[str, Near] = field(default_factory=dict)
    """Expected modes by the keys of ``MODES``."""
    levels: Mapping[AxisName, Mapping[Category, int]] = field(default_factory=dict)
    """Worst allowed level of MIL-F-8785C, by axis and category of flight phases."""
    gap: Mapping[AxisName, float] = field(default_factory=dict)
    """Largest allowed gap of the simulator as given, by axis."""
    longest_pause_s: Mapping[str, float] = field(default_factory=dict)
    """Longest allowed pause between two samples, s, by channel."""
    alarms: int | None = None
    """Largest allowed number of alarms."""

    @property
    def asks_of_log(self) -> bool:
        """Whether an expected value comes from another log."""
        return any(near.origin == "log" for near in (*self.derivatives.values(), *self.modes.values()))


_TOLERANCES = ("within", "within_percent", "known_to")
_LEVELS = 3
"""Worst level of flying qualities in MIL-F-8785C."""
_MEND = "To write a first file from a log, type: advisor expect LOG new.yaml --write."
_ORIGINS = ("model", "log")

_Count = Annotated[int, must("a whole number of at least 1", lambda x: x >= 1 and x == int(x))]
_Alarms = Annotated[int, must("a whole number of at least 0", lambda x: x >= 0 and x == int(x))]
_Level = Annotated[int, must(f"a level of 1 to {_LEVELS}", lambda x: x in range(1, _LEVELS + 1))]
_Gap = Annotated[float, must("a number of at least 0", lambda x: x >= 0.0)]
_AboveZero = Annotated[float, must("a number above 0", lambda x: x > 0.0)]
_Of = Annotated[float | Literal["model", "log"], must("a number, model, or log", words=_ORIGINS)]


def _each_category(given: Any) -> Any:
    """Return the worst allowed level by category; one number holds for every category."""
    return given if isinstance(given, dict) else dict.fromkeys(CATEGORIES, given)


@strict
@dataclass(frozen=True)
class _Near:
    of: _Of | None = None
    within: _AboveZero | None = None
    within_percent: _AboveZero | None = None
    known_to: _AboveZero | None = None

    def read(self) -> Near:
        tolerances = {name: getattr(self, name) for name in _TOLERANCES}
        if isinstance(self.of, str):
            return Near(origin=self.of, **tolerances)
        return Near(value=self.of, **tolerances)


@strict
@dataclass(frozen=True)
class _File:
    log: str | None = None
    accepted: dict[AxisName, _Count] = field(default_factory=dict)
    complete: dict[AxisName, _Count] = field(default_factory=dict)
    derivatives: dict[str, _Near] = field(default_factory=dict)
    modes: dict[str, _Near] = field(default_factory=dict)
    levels: dict[AxisName, Annotated[dict[Category, _Level], BeforeValidator(_each_category)]] = field(
        default_factory=dict
    )
    gap: dict[AxisName, _Gap] = field(default_factory=dict)
    longest_pause_s: dict[str, _AboveZero] = field(default_factory=dict)
    alarms: _Alarms | None = None


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
    file = read_settings(path, _File, _MEND, partial(_mistakes, folder=path.parent, aircraft=aircraft))
    sections = {name: getattr(file, name) for name in SECTIONS}
    for name in ("derivatives", "modes"):
        sections[name] = {key: near.read() for key, near in sections[name].items()}
    expected = Expectations(**{**sections, "log": None if file.log is None else path.parent / file.log})
    if expected == Expectations(log=expected.log):
        asked = ", ".join(SECTIONS[1:])
        raise ConfigurationError(f"{path}: file: expects nothing; give at least one of {asked}. {_MEND}")
    return expected


def _mistakes(file: _File, folder: Path, aircraft: Aircraft) -> Iterator[str]:
    yield from _mistakes_in("derivatives", file.derivatives, (*PARAMETERS, *SIDE_PARAMETERS))
    yield from _mistakes_in("modes", file.modes, tuple(MODES))
    for name, near in file.derivatives.items():
        if near.of == "model" and name not in aircraft.model:
            yield (
                f"derivatives.{name}.of: the aircraft file's model has no {name}; name it there (--aircraft)"
            )
    for name, near in file.modes.items():
        if near.of == "model" and name in MODES and (missing := lacking(aircraft.model, name)):
            yield f"modes.{name}.of: the aircraft file's model has no {' '.join(missing)} (--aircraft)"
    model = aircraft.model
    stated = {
        "pitch": all(n in model for n in DERIVATIVES),
        "lateral": any(n in model for n in SIDE_PARAMETERS),
    }
    for axis in file.gap:
        if aircraft.simulator is None and not stated[axis]:
            yield (f"gap.{axis}: the aircraft file gives no simulator of this axis; state one there")
    if file.log is not None and not (folder / file.log).is_file():
        yield f"log: there is no file {folder / file.log}"
    if file.log is None and any(
        near.of == "log" for near in (*file.derivatives.values(), *file.modes.values())
    ):
        yield "log: is missing, but an expected value refers to a log"


def _mistakes_in(section: str, expected: Mapping[str, _Near], names: tuple[str, ...]) -> Iterator[str]:
    for name, near in expected.items():
        path = f"{section}.{name}"
        if name not in names:
            yield f"{path}: unknown key{resembling(name, names)}"
        if all(getattr(near, tolerance) is None for tolerance in _TOLERANCES):
            yield f"{path}: needs a tolerance: {', '.join(_TOLERANCES)}"
        elif near.of is None and (near.within is not None or near.within_percent is not None):
            yield f"{path}.of: is missing: give a number, model, or log"
        elif near.of == 0.0 and near.within_percent is not None and near.within is None:
            yield f"{path}.within_percent: gives no tolerance for an expected value of 0; give within"
