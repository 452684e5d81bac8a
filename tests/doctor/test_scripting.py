from advisor.doctor.examiner import script_notes
from advisor.flight.vehicle.surfaces import Part, Scale, Surface

ELEVATOR = Surface((Part(2, Scale()),), False, "")
READY = {"SCR_ENABLE": 1.0, "SCR_HEAP_SIZE": 65_536.0, "SERVO2_FUNCTION": 19.0}


def test_a_vehicle_that_flies_scripts_needs_no_word() -> None:
    assert script_notes(READY, ELEVATOR) == []


def test_parameters_that_no_source_states_need_no_word() -> None:
    assert script_notes({}, ELEVATOR) == []


def test_scripting_that_is_off_is_said_with_the_parameter_to_set() -> None:
    assert script_notes(READY | {"SCR_ENABLE": 0.0}, ELEVATOR) == [
        "SCR_ENABLE is 0, so the vehicle flies no script: set SCR_ENABLE 1 and restart it."
    ]


def test_a_heap_that_is_too_small_is_said_with_the_size_needed() -> None:
    (note,) = script_notes(READY | {"SCR_HEAP_SIZE": 20_000.0}, ELEVATOR)
    assert note.startswith("SCR_HEAP_SIZE is 20000 (a script of all inputs needs 65536)")


def test_an_elevator_output_without_a_function_is_said() -> None:
    (note,) = script_notes(READY | {"SERVO2_FUNCTION": 0.0}, ELEVATOR)
    assert note.startswith("SERVO2_FUNCTION is 0")
