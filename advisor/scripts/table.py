"""The table of a script: its inputs with their sizes, for one aircraft."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.script_identity import ScriptIdentity
from advisor.decision.conditions import travel_of
from advisor.scripts.flight_limits import FlightLimits
from advisor.scripts.inputs import CONTROLS, NAMES, Control, ScriptInput, input_of
from advisor.scripts.outputs import StatedOutput, stated_outputs
from advisor.scripts.pace import Pace, pace_of
from advisor.scripts.sizes import Size, size_of


@dataclass(frozen=True, slots=True)
class Source:
    """Knowledge about the aircraft beyond its file."""

    model: Mapping[str, float] = field(default_factory=dict)
    """Derivatives by name, rad and s."""
    said: str = ""
    """Source of the derivatives, as a noun: ``the aircraft file's model``."""
    flown_rad: Mapping[Control, float] = field(default_factory=dict)
    """Largest deflection from trim in accepted manoeuvres, rad, by the control."""
    controls: tuple[Control, ...] = CONTROLS
    """Controls that the aircraft has."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """SERVOn parameters of a log, by name, which the script compares with the vehicle's."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One input of a table with the sizes of its controls."""

    test: ScriptInput
    sizes: Mapping[Control, Size]


@dataclass(frozen=True, slots=True)
class ScriptTable:
    """All that a script states at its top."""

    aircraft: Aircraft
    pace: Pace
    entries: tuple[Entry, ...]
    limits: FlightLimits
    switch: int
    """Radio channel of the switch, 1 to 16, or the option 300 to 307 of the switch's RCn_OPTION."""
    outputs: Mapping[Control, tuple[StatedOutput, ...]]
    parameters: Mapping[str, float]

    @property
    def identity(self) -> ScriptIdentity:
        """Name and calibrations of the aircraft file, as the script states them."""
        return ScriptIdentity.of(self.aircraft)

    def travel_rad(self, control: Control) -> float:
        """Return the travel of a control from neutral to the nearer stop, rad."""
        return travel_of(getattr(self.aircraft, control).ends_deg)


def script_table(
    aircraft: Aircraft,
    source: Source,
    names: Sequence[str] = NAMES,
    period_s: float | None = None,
    switch: int = 7,
    limits: FlightLimits | None = None,
) -> ScriptTable:
    """Return the table of a script for one aircraft.

    Inputs of a control that the aircraft lacks are left out; a multisine then moves the others.
    """
    pace = pace_of(source.model, source.said, period_s)
    entries = []
    for name in names:
        test = input_of(name, pace, source.controls)
        if set(test.moved) <= set(source.controls):
            sizes = {
                control: size_of(test, control, aircraft, source.model, source.flown_rad.get(control))
                for control in test.moved
            }
            entries.append(Entry(test, sizes))
    return ScriptTable(
        aircraft,
        pace,
        tuple(entries),
        limits or FlightLimits.of(aircraft),
        switch,
        {control: stated_outputs(aircraft, control) for control in CONTROLS},
        source.parameters,
    )
