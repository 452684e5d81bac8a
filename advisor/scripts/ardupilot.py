"""The script for ArduPlane's scripting engine: the numbers of a table, then ``inflight.lua``.

ArduPlane runs the script in Lua 5.3 with at most 10,000 instructions a call (SCR_VM_I_COUNT). The script
therefore computes a multisine sample by sample from its lines, and reads the outputs' limits on the vehicle.
"""

from collections.abc import Iterable, Mapping
from importlib.resources import files
from math import degrees
from typing import Any

from advisor.decision.conditions import ALPHA_MARGIN, FULL_TRAVEL_RAD
from advisor.scripts.inputs import CONTROLS, NAMES, Control
from advisor.scripts.table import Entry, ScriptTable, StatedOutput, factors_by_function

UNIT_S = (0.1, 5.0)
"""Shortest and longest time unit that a script flies by an order, s. A servo cannot follow shorter steps, and
longer steps take too long.
"""
_PLACE = "-- @DATA@\n"


def ardupilot_script(table: ScriptTable) -> str:
    """Return the text of a script for ArduPlane."""
    body = files("advisor.scripts").joinpath("inflight.lua").read_text(encoding="utf-8")
    return body.replace(_PLACE, "\n".join([*_head(table), ""]), 1)


def _head(table: ScriptTable) -> list[str]:
    limits, pace, why = table.limits, table.pace, table.pace.why
    switch = f"radio channel {table.switch}" if table.switch < 300 else f"RCn_OPTION {table.switch}"
    return [
        f"-- Test inputs of {table.identity.name}, for ArduPlane. Written by: advisor script ardupilot.",
        "-- Safety: try the switch on the ground with the propeller off, then fly high for the first time.",
        f"-- The switch ({switch}) up starts the next input, down ends it at once.",
        f"-- Short period {pace.period_s:.3g} s ({why['period_s']}).",
        f"-- Roll time constant {pace.roll_s:.3g} s ({why['roll_s']}).",
        f"-- Dutch roll {pace.dutch_roll_s:.3g} s ({why['dutch_roll_s']}).",
        "",
        f"local AIRCRAFT = {_text(table.identity.name)}",
        f'local HASH = "{table.identity.calibration}"     -- of the calibrations and stated outputs',
        _number("SWITCH", table.switch, switch),
        _number("BANK_DEG", limits.bank_deg, "deg, largest bank: limits.bank_deg of the aircraft file"),
        _number("PITCH_DEG", limits.pitch_deg, "deg, largest change of the pitch angle in an input"),
        _number(
            "AIRSPEED_PERCENT",
            limits.airspeed_percent,
            "%, largest change of the air speed: limits.airspeed_change_percent",
        ),
        _number("LOWEST_M", limits.lowest_m, "m above home, below which an input ends; 0: ground check"),
        _number("STICK_PERCENT", limits.stick_percent, "% of travel, motion of a stick that ends an input"),
        _number("LINK_S", limits.link_s, "s, silence of a ground station that was heard before"),
        _number(
            "FULL_TRAVEL_DEG",
            degrees(FULL_TRAVEL_RAD),
            "deg at SERVOn_MIN and MAX, assumed for controls without a calibration",
        ),
        f"local UNIT_S = {{{UNIT_S[0]:g}, {UNIT_S[1]:g}}}     -- s, shortest and longest unit of an order",
        f"local LARGEST_DEG = {_table(_largest(table))}     -- deg, {100 * ALPHA_MARGIN:.0f} % of the travel",
        "",
        "-- Degrees of an output for one degree of each control, by SERVOn_FUNCTION: the mixer.",
        f"local FACTORS = {{{', '.join(f'[{n}] = {_table(m)}' for n, m in factors_by_function().items())}}}",
        "-- Outputs in the aircraft file; a control without an entry moves those with its SERVOn_FUNCTION.",
        f"local STATED = {{{', '.join(f'{c} = {{{_stated(table.outputs[c])}}}' for c in CONTROLS)}}}",
        "-- Pulse in us and deflection in deg of each control's first output, from the aircraft file.",
        f"local CALIBRATION = {{{_calibrations(table)}}}",
        "-- Parameters of the log; the script says which one differs on the vehicle.",
        f"local PARAMETERS = {_table(table.parameters)}",
        "",
        "-- Inputs. Steps: units of time, share of the size. Sines: periods within the length, phase in rad.",
        "-- Deflections: elevator positive trailing edge down, aileron to the left, rudder to the left.",
        "local INPUTS = {",
        *(line for entry in table.entries for line in _entry(entry)),
        "}",
        f"local TABLE = {{{', '.join(map(str, range(1, 1 + len(table.entries))))}}}     -- order of inputs",
        f"local NEEDED = {{{', '.join(f'{c} = true' for c in CONTROLS if _moves(table, c))}}}",
    ]


def _largest(table: ScriptTable) -> dict[Control, float]:
    return {c: ALPHA_MARGIN * degrees(table.travel_rad(c)) for c in CONTROLS}


def _moves(table: ScriptTable, control: Control) -> bool:
    return any(control in entry.test.moved for entry in table.entries)


def _number(name: str, value: float, why: str) -> str:
    return f"local {name} = {value:g}     -- {why}"


def _text(text: str) -> str:
    """Return a string of Lua, with quotes and backslashes escaped."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _table(values: Mapping[Any, float]) -> str:
    return f"{{{', '.join(f'{name} = {value:.6g}' for name, value in values.items())}}}"


def _pairs(pairs: Iterable[tuple[float, float]]) -> str:
    return f"{{{', '.join(f'{{{a:.6g}, {b:.6g}}}' for a, b in pairs)}}}"


def _stated(outputs: Iterable[StatedOutput]) -> str:
    return ", ".join(
        f"{{n = {output.output}, factor = {output.factor:g}, "
        f"us_deg = {_pairs(sorted(output.calibration)) if output.calibration else 'nil'}}}"
        for output in outputs
    )


def _calibrations(table: ScriptTable) -> str:
    stated = {c: getattr(table.aircraft, c).calibration for c in CONTROLS}
    return ", ".join(f"{c} = {_pairs(sorted(pairs))}" for c, pairs in stated.items() if pairs)


def _entry(entry: Entry) -> list[str]:
    test = entry.test
    held, moves = (", ".join(f'"{c}"' for c in controls) for controls in (test.held, test.moved))
    sizes = _table({c: degrees(size.rad) for c, size in entry.sizes.items()})
    reasons = "; ".join(f"{c}: {size.why}" for c, size in entry.sizes.items())
    lines = [
        f"  {{ -- sizes in deg. {reasons}",
        f"    name = {_text(test.name)}, which = {1 + NAMES.index(test.name)},",
        f"    moves = {{{moves}}}, held = {{{held}}},",
        f"    sizes = {sizes}, rest_s = {test.rest_s:g},",
    ]
    if test.sines is None:
        return [*lines, f"    unit_s = {test.unit_s:g}, steps = {_pairs(test.steps)},", "  },"]
    lines.append(f"    unit_s = 0, length_s = {test.length_s:g}, sines = {{")
    for control, sines in test.sines.items():
        waves = ", ".join(
            f"{{{k}, {phase:.5f}}}" for k, phase in zip(sines.harmonics, sines.phases_rad, strict=True)
        )
        lines.append(f"      {control} = {{amplitude = {sines.amplitude:.5f}, {waves}}},")
    return [*lines, "    },", "  },"]
