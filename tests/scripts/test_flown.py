"""The script's logic, run by a Lua interpreter against a stub of ArduPilot's engine."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator, ElevatorOutput, SideControl
from advisor.flight.elevator.elevator_outputs import find_elevator, find_side_control
from advisor.flight.vehicle.ardupilot_wiring import ardupilot_wiring
from advisor.flight.vehicle.surfaces import Surface
from advisor.scripts.ardupilot import ardupilot_script
from advisor.scripts.inputs import CONTROLS, NAMES, STEPPED
from advisor.scripts.table import FlightLimits, ScriptTable, Source, script_table
from tests.scripts.engine import BUDGET, USUAL, Engine

STEADY_S, BOUNCE_S = 2.0, 0.3
ELEVONS = {"SERVO1_FUNCTION": 77.0, "SERVO2_FUNCTION": 78.0, "SERVO2_REVERSED": 1.0}
V_TAIL = {"SERVO2_FUNCTION": 79.0, "SERVO4_FUNCTION": 80.0, "SERVO4_TRIM": 1450.0}
FLAPERONS = {"SERVO1_FUNCTION": 24.0, "SERVO5_FUNCTION": 25.0, "SERVO5_MIN": 1000.0}
TWO_AILERONS = {"SERVO5_FUNCTION": 4.0, "SERVO5_REVERSED": 1.0, "SERVO5_TRIM": 1520.0}
AIRFRAMES = {"plain": {}, "elevons": ELEVONS, "V-tail": V_TAIL, "flaperons": FLAPERONS, "two": TWO_AILERONS}
CALIBRATED = Aircraft(
    elevator=Elevator(calibration=((1150.0, 18.0), (1480.0, 0.0), (1850.0, -24.0))),
    aileron=SideControl(calibration=((1100.0, 20.0), (1500.0, 0.0), (1900.0, -20.0))),
)


def _table(*names: str, aircraft: Aircraft | None = None, switch: int = 7) -> ScriptTable:
    return script_table(aircraft or Aircraft(), Source(), names or NAMES, switch=switch)


def _loaded(table: ScriptTable, call_ms: int = 10, **parameters: float) -> Engine:
    engine = Engine(parameters=dict(USUAL) | parameters, call_ms=call_ms)
    engine.load(ardupilot_script(table))
    engine.run(0.5)
    return engine


def _surface(control: str, aircraft: Aircraft, engine: Engine) -> Surface:
    """Return the control as the advisor's own reader knows it."""
    wiring = ardupilot_wiring(engine.parameters)
    if control == "elevator":
        found = find_elevator(aircraft.elevator, wiring)
    else:
        found = find_side_control(control, getattr(aircraft, control), wiring)  # type: ignore[arg-type]
    assert isinstance(found, Surface)
    return found


def _flown(engine: Engine, control: str, aircraft: Aircraft, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Fly for some seconds; return times, ms, and what the advisor reads of a control, deg."""
    surface = _surface(control, aircraft, engine)
    rows: list[tuple[int, list[int]]] = []
    engine.run(seconds, lambda: rows.append((engine.ms, [engine.pulse(n) for n in surface.outputs])))
    pulses = np.array([pulses for _, pulses in rows], dtype=float)
    return np.array([ms for ms, _ in rows]), np.degrees(surface.deflection(pulses))


def _in_flight(*names: str, seconds: float = 0.3, table: ScriptTable | None = None) -> Engine:
    """Return an engine within an input, ``seconds`` after its begin."""
    engine = _loaded(table or _table(*(names or ("3-2-1-1",))))
    engine.radio[7] = 1900
    engine.run(BOUNCE_S + STEADY_S + 0.05 + seconds)
    assert len(engine.said("ADVISOR BEGIN")) == 1
    return engine


@pytest.mark.parametrize("airframe", AIRFRAMES)
@pytest.mark.parametrize("name", STEPPED)
@pytest.mark.parametrize("aircraft", [Aircraft(), CALIBRATED], ids=["assumed", "calibrated"])
def test_the_advisor_reads_the_steps_that_were_asked(airframe: str, name: str, aircraft: Aircraft) -> None:
    if airframe == "elevons" and name == "rudder doublet":
        pytest.skip("this airframe has elevons and a rudder of its own, as tested with the plain one")
    table = _table(name, aircraft=aircraft)
    (entry,) = table.entries
    (control,) = entry.test.moved
    engine = _loaded(table, **AIRFRAMES[airframe])
    engine.radio[7] = 1900
    t, read = _flown(engine, control, aircraft, 4.0 + entry.test.length_s)
    begin, size = engine.at_ms("ADVISOR BEGIN"), np.degrees(entry.sizes[control].rad)
    trim = read[t < begin][-1]
    onset = float(begin)
    for units, share in entry.test.steps:
        end = onset + 1000.0 * units * entry.test.unit_s
        held = (t > onset + 20.0) & (t < end - 1.0)
        assert read[held] - trim == pytest.approx(share * size, abs=0.03 * size + 0.04)
        onset = end
    assert read[(t > onset + 20.0)] - trim == pytest.approx(0.0, abs=0.04)


def test_a_multisine_moves_each_control_by_its_own_lines() -> None:
    table = _table("multisine")
    (entry,) = table.entries
    assert entry.test.sines is not None
    engine = _loaded(table)
    engine.radio[7] = 1900
    outputs = {"elevator": 2, "aileron": 1, "rudder": 4}
    rows: list[tuple[int, ...]] = []
    engine.run(24.0, lambda: rows.append((engine.ms, *(engine.pulse(n) for n in outputs.values()))))
    times, *pulses = np.array(rows, dtype=float).T
    flown = {
        control: _surface(control, Aircraft(), engine).deflection(us[:, None])
        for control, us in zip(outputs, pulses, strict=True)
    }
    begin = engine.at_ms("ADVISOR BEGIN")
    share = (times - begin) / (1000.0 * entry.test.length_s)
    inside = (share > 0.001) & (share < 0.999)
    for control in CONTROLS:
        wanted = entry.sizes[control].rad * entry.test.sines[control].values(share[inside])
        read = flown[control][inside]
        trim = flown[control][0]
        # A sample waits up to 10 ms for its call, in which the fastest line moves by a tenth of the size.
        assert np.max(np.abs(read - trim - wanted)) < 0.15 * entry.sizes[control].rad
        assert np.corrcoef(read, wanted)[0, 1] > 0.995


def test_the_table_is_flown_in_its_order_and_begins_again() -> None:
    engine = _loaded(_table("rudder doublet", "3-2-1-1"))
    for _ in range(3):
        engine.radio[7] = 1900
        engine.run(12.0)
        engine.radio[7] = 1000
        engine.run(0.2)
    assert engine.said("ADVISOR BEGIN") == [
        "ADVISOR BEGIN 1 rudder doublet", "ADVISOR BEGIN 2 3-2-1-1", "ADVISOR BEGIN 3 rudder doublet",
    ]  # fmt: skip
    assert engine.said("ADVISOR END") == [f"ADVISOR END {n} done" for n in (1, 2, 3)]


def _switch_back(engine: Engine) -> None:
    engine.radio[7] = 1000


def _grab(engine: Engine) -> None:
    engine.radio[2] = 1560


def _change_mode(engine: Engine) -> None:
    engine.mode = 11


def _lose_radio(engine: Engine) -> None:
    engine.radio_is_valid = False


def _disarm(engine: Engine) -> None:
    engine.armed = False


def _state(name: str, value: float) -> Callable[[Engine], None]:
    return lambda engine: engine.state.__setitem__(name, value)


ABORTS: dict[str, Callable[[Engine], None]] = {
    "switch": _switch_back,
    "stick": _grab,
    "mode changed": _change_mode,
    "RC failsafe": _lose_radio,
    "disarmed": _disarm,
    "height 29 m": _state("height", 29.0),
    "bank -31 deg": _state("roll", np.radians(-31.0)),
    "pitch by 31 deg": _state("pitch", np.radians(31.0)),
    "air speed by 16 %": _state("airspeed", 23.2),
    "air speed by -16 %": _state("airspeed", 16.8),
}


@pytest.mark.parametrize("name", ["3-2-1-1", "multisine"])
@pytest.mark.parametrize("why", ABORTS)
def test_every_abort_gives_the_surfaces_back_within_a_tenth_of_a_second(name: str, why: str) -> None:
    engine = _in_flight(name)
    assert engine.pulse(2) != engine.flown[2]
    engine.flown[2] = 1600
    ABORTS[why](engine)
    engine.run(0.1)
    assert engine.said("ADVISOR END") == [f"ADVISOR END 1 aborted: {why}"]
    assert [engine.pulse(n) for n in (1, 2, 4)] == [1504, 1600, 1500]
    engine.run(1.0)
    assert engine.pulse(2) == 1600


def test_a_ground_station_that_falls_silent_ends_the_input() -> None:
    engine = _loaded(_table("multisine"))
    engine.link_ms = engine.ms
    engine.radio[7] = 1900
    for _ in range(40):
        engine.run(0.1)
        engine.link_ms = engine.ms
    engine.run(3.1)
    assert engine.said("ADVISOR END") == ["ADVISOR END 1 aborted: link lost"]


def test_without_a_ground_station_the_input_is_flown_to_its_end() -> None:
    engine = _in_flight("3-2-1-1", seconds=4.0)
    assert engine.said("ADVISOR END") == ["ADVISOR END 1 done"]


def test_a_script_that_dies_lets_go_within_150_ms() -> None:
    engine = _in_flight("3-2-1-1")
    engine.ms += 151
    assert engine.pulse(2) == engine.flown[2]


def test_only_the_surfaces_of_the_test_are_held() -> None:
    engine = _in_flight("3-2-1-1")
    engine.flown |= {1: 1610, 4: 1390}
    assert (engine.pulse(1), engine.pulse(4)) == (1610, 1390)


def test_a_lateral_input_holds_the_rudder_still_beside_the_aileron() -> None:
    engine = _in_flight("aileron doublet")
    engine.flown |= {2: 1610, 4: 1390}
    assert (engine.pulse(2), engine.pulse(4)) == (1610, 1500)


def test_a_switch_that_bounces_starts_nothing() -> None:
    engine = _loaded(_table("3-2-1-1"))
    for _ in range(40):
        engine.radio[7] = 1900
        engine.run(0.1)
        engine.radio[7] = 1000
        engine.run(0.05)
    assert engine.said("ADVISOR BEGIN") == []


def test_a_switch_that_is_up_while_the_script_loads_starts_nothing() -> None:
    engine = Engine()
    engine.radio[7] = 1900
    engine.load(ardupilot_script(_table("3-2-1-1")))
    engine.run(6.0)
    assert engine.said("ADVISOR BEGIN") == []


def test_a_switch_that_stays_up_flies_one_input() -> None:
    assert len(_in_flight("3-2-1-1", seconds=20.0).said("ADVISOR BEGIN")) == 1


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [
        ("roll", 0.35, "bank"),
        ("height", 20.0, "height 20 m"),
        ("airspeed", 8.0, "air speed below AIRSPEED_MIN"),
    ],
)
def test_the_script_waits_for_steady_flight_and_says_for_what(name: str, value: float, why: str) -> None:
    engine = _loaded(_table("3-2-1-1"))
    engine.state[name] = value
    engine.radio[7] = 1900
    engine.run(8.0)
    assert engine.said("ADVISOR BEGIN") == []
    assert engine.said("ADVISOR WAITS")[-1] == f"ADVISOR WAITS: {why}"


def test_a_script_for_the_ground_check_moves_the_surfaces_at_no_height_and_no_air_speed() -> None:
    table = script_table(Aircraft(), Source(), ("3-2-1-1",), limits=FlightLimits.of(Aircraft(), lowest_m=0.0))
    engine = _loaded(table)
    engine.state |= {"height": -0.4, "airspeed": 0.5}
    engine.radio[7] = 1900
    engine.run(BOUNCE_S + STEADY_S + 0.3)
    assert len(engine.said("ADVISOR BEGIN")) == 1
    engine.run(5.0)
    assert engine.said("ADVISOR END") == ["ADVISOR END 1 done"]


def test_a_stick_that_moves_delays_the_begin() -> None:
    engine = _loaded(_table("3-2-1-1"))
    engine.radio[7] = 1900
    for k in range(40):
        engine.radio[2] = 1500 + 40 * (k % 2)
        engine.run(0.1)
    assert engine.said("ADVISOR BEGIN") == []
    engine.run(2.5)
    assert len(engine.said("ADVISOR BEGIN")) == 1


def test_the_trim_of_the_last_second_is_held() -> None:
    engine = _loaded(_table("3-2-1-1"))
    engine.radio[7] = 1900
    engine.run(BOUNCE_S + 0.8)
    engine.flown[2] = 1530
    engine.run(STEADY_S + 2.5)
    assert engine.said("ADVISOR END") == []
    assert engine.pulse(2) == 1530


def test_the_switch_may_be_the_channel_of_an_option() -> None:
    script = ardupilot_script(_table("3-2-1-1", switch=302))
    assert "local SWITCH = 302     -- RCn_OPTION 302" in script


@pytest.mark.parametrize("name", NAMES)
def test_no_call_needs_half_of_the_instructions_that_are_allowed(name: str) -> None:
    engine = _in_flight(name, seconds=2.0)
    assert engine.most < BUDGET / 2


def test_a_board_of_20_hz_says_that_its_steps_are_inexact() -> None:
    engine = _loaded(_table("3-2-1-1"), call_ms=50)
    engine.radio[7] = 1900
    engine.run(8.0)
    assert engine.said("ADVISOR END") == ["ADVISOR END 1 done"]
    assert engine.said("ADVISOR LATE") == ["ADVISOR LATE: calls up to 50 ms apart in 1"]


def test_an_output_at_the_end_of_its_travel_begins_nothing() -> None:
    engine = _loaded(_table("3-2-1-1"))
    engine.flown[2] = 1895
    engine.radio[7] = 1900
    engine.run(4.0)
    assert engine.said("ADVISOR BEGIN") == []
    assert engine.said("ADVISOR CANNOT BEGIN") == ["ADVISOR CANNOT BEGIN: output 2 lacks travel"]


def test_a_stated_output_without_a_function_is_refused() -> None:
    stated = Aircraft(elevator=replace(Elevator(), output=9))
    engine = _loaded(_table("3-2-1-1", aircraft=stated))
    engine.radio[7] = 1900
    engine.run(4.0)
    assert "ADVISOR CANNOT FLY: output 9 has function 0" in engine.said("ADVISOR CANNOT")
    assert engine.said("ADVISOR BEGIN") == []


def test_outputs_of_the_aircraft_file_are_moved_together() -> None:
    halves = ElevatorOutput(6, ((1100.0, -25.0), (1900.0, 25.0))), ElevatorOutput(2, None)
    aircraft = Aircraft(elevator=Elevator(outputs=halves))
    engine = _loaded(_table("3-2-1-1", aircraft=aircraft), SERVO6_FUNCTION=19.0)
    engine.flown |= {6: 1500, 2: 1500}
    engine.radio[7] = 1900
    engine.run(BOUNCE_S + STEADY_S + 0.3)
    assert (engine.pulse(2), engine.pulse(6)) == (1521, 1479)


def test_an_aircraft_without_a_rudder_skips_its_inputs() -> None:
    engine = _loaded(_table("rudder doublet", "3-2-1-1"), SERVO4_FUNCTION=0.0)
    assert engine.said("ADVISOR no output") == ["ADVISOR no output of the rudder"]
    engine.radio[7] = 1900
    engine.run(3.0)
    assert engine.said("ADVISOR BEGIN") == ["ADVISOR BEGIN 1 3-2-1-1"]


def test_a_parameter_that_differs_from_the_log_is_named() -> None:
    table = script_table(Aircraft(), Source(parameters={"SERVO2_TRIM": 1480.0}))
    assert "ADVISOR SERVO2_TRIM is 1500, in the log 1480" in _loaded(table).said("ADVISOR SERVO2")


def test_the_script_says_its_aircraft_and_calibration_when_it_loads_and_when_the_vehicle_arms() -> None:
    table = _table(aircraft=Aircraft(name='my "own" aircraft'))
    engine = Engine(armed=False)
    engine.load(ardupilot_script(table))
    line = f'ADVISOR SCRIPT my "own" aircraft {table.identity.calibration}'
    assert engine.said("ADVISOR SCRIPT") == [line]
    engine.armed = True
    engine.run(0.1)
    assert engine.said("ADVISOR SCRIPT") == [line, line]


def _order(engine: Engine, which: float, size: float, unit: float, counter: float) -> None:
    for k, value in enumerate((which, size, unit, counter), 1):
        engine.parameters[f"SCR_USER{k}"] = value
    engine.run(0.1)


def test_an_order_of_the_advisor_is_echoed_and_flown_once() -> None:
    engine = _loaded(_table())
    _order(engine, 2, 3.0, 0.3, 5)
    assert engine.said("ADVISOR NEXT")[-1] == "ADVISOR NEXT 5 reverse 3-2-1-1 0.30 s 3.0 deg"
    engine.radio[7] = 1900
    engine.run(BOUNCE_S + STEADY_S + 0.3)
    assert engine.said("ADVISOR BEGIN") == ["ADVISOR BEGIN 1 reverse 3-2-1-1"]
    assert engine.pulse(2) == 1490 - 32
    engine.run(8.0)
    assert engine.said("ADVISOR NEXT")[-1].startswith("ADVISOR NEXT 0 3-2-1-1")


@pytest.mark.parametrize(
    ("which", "size", "unit", "why"),
    [(9, 1.0, 0.3, "no such input"), (1, 24.0, 0.3, "size 24.0 deg"), (1, 1.0, 0.02, "unit 0.02 s")],
)
def test_an_order_beyond_the_script_is_refused(which: float, size: float, unit: float, why: str) -> None:
    engine = _loaded(_table())
    _order(engine, which, size, unit, 5)
    assert engine.said("ADVISOR REFUSES") == [f"ADVISOR REFUSES 5: {why}"]
    assert len(engine.said("ADVISOR NEXT")) == 1


def test_an_order_counts_the_inputs_of_all_scripts_whatever_this_one_holds() -> None:
    engine = _loaded(_table("multisine", "reverse 3-2-1-1"))
    _order(engine, 2, 3.0, 0.3, 5)
    assert engine.said("ADVISOR NEXT")[-1] == "ADVISOR NEXT 5 reverse 3-2-1-1 0.30 s 3.0 deg"
    _order(engine, 1, 3.0, 0.3, 6)
    assert engine.said("ADVISOR REFUSES") == ["ADVISOR REFUSES 6: no such input"]


def test_an_order_ends_the_multisine_after_its_hands_off_flight() -> None:
    engine = _in_flight("multisine", seconds=8.0)
    _order(engine, 0, -1, 0, 5)
    assert engine.said("ADVISOR ENOUGH") == ["ADVISOR ENOUGH 5"]
    ended_ms = engine.ms
    trims = {n: engine.pulse(n) for n in (1, 2, 4)}
    assert trims == {1: 1504, 2: 1490, 4: 1500}
    engine.flown[2] = 1600
    engine.run(3.8)
    assert {n: engine.pulse(n) for n in (1, 2, 4)} == trims
    engine.run(0.3)
    assert engine.said("ADVISOR END") == ["ADVISOR END 1 done: enough"]
    assert engine.at_ms("ADVISOR END") - ended_ms == pytest.approx(4000, abs=150)
    assert engine.pulse(2) == 1600


@pytest.mark.parametrize(("name", "number"), [("multisine", 2), ("3-2-1-1", 1)])
def test_only_the_multisine_that_is_flown_can_be_ended(name: str, number: int) -> None:
    engine = _in_flight(name)
    _order(engine, 0, -number, 0, 5)
    assert engine.said("ADVISOR REFUSES") == [f"ADVISOR REFUSES 5: no multisine {number} to end"]
    engine.run(30.0)
    assert engine.said("ADVISOR END") == ["ADVISOR END 1 done"]


def test_an_order_to_end_that_comes_late_flies_nothing() -> None:
    engine = _loaded(_table())
    _order(engine, 0, -1, 0, 5)
    assert engine.said("ADVISOR REFUSES") == ["ADVISOR REFUSES 5: no such input"]


def test_a_next_input_that_is_ordered_within_an_input_waits_for_its_end() -> None:
    engine = _in_flight(seconds=2.0, table=_table("multisine", "reverse 3-2-1-1"))
    _order(engine, 2, 3.0, 0.3, 5)
    assert len(engine.said("ADVISOR NEXT")) == 1
    engine.run(24.0)
    assert engine.said("ADVISOR NEXT")[-1] == "ADVISOR NEXT 5 reverse 3-2-1-1 0.30 s 3.0 deg"


def test_an_order_of_before_the_script_was_loaded_counts_for_nothing() -> None:
    engine = _loaded(_table(), SCR_USER1=2.0, SCR_USER2=3.0, SCR_USER3=0.3, SCR_USER4=5.0)
    assert engine.said("ADVISOR NEXT")[-1].startswith("ADVISOR NEXT 0")


def test_every_text_fits_into_one_message() -> None:
    engine = _in_flight("reverse 3-2-1-1")
    engine.state["airspeed"] = 16.8
    engine.run(0.1)
    assert all(len(text) <= 50 for _, text in engine.texts)


def test_marks_alternate_and_carry_one_number_each() -> None:
    engine = _loaded(_table())
    for _ in range(4):
        engine.radio[7] = 1900
        engine.run(4.0)
        engine.radio[7] = 1000
        engine.run(0.2)
    marks = [text.split()[1:3] for _, text in engine.texts if text.split()[1] in ("BEGIN", "END")]
    assert [mark for mark, _ in marks] == ["BEGIN", "END"] * 4
    assert all(a[1] == b[1] for a, b in list(pairwise(marks))[::2])
