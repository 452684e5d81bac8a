"""Inputs as hands fly them, short records, closed loops: found in flights of the bundled simulator."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest

from advisor.flight.maneuvers.maneuver import Activity, ManeuverFlown
from sim.flight import Flight
from sim.record import record
from sim.scenario import Air, Maneuver, Noise, Scenario
from tests.heard import hear_log
from tests.unstable import unstable_flight

FOLDER = Path(mkdtemp(prefix="hand-"))
BOOT_S = Scenario().clock.boot_s
HANDS = {
    "slewed as long as the step": Maneuver("3211", slew_s=0.3),
    "slewed and uneven": Maneuver("rev", slew_s=0.3, uneven=0.3),
    "on a moving stick": Maneuver("3211", slew_s=0.2, uneven=0.15, stick=0.1),
    "corrected just before": Maneuver("rev", slew_s=0.2, corrected=0.3),
    "with another trim afterwards": Maneuver("3211", slew_s=0.3, trim_after=0.3),
    "with half of the amplitude": Maneuver("rev", slew_s=0.3, amplitude_deg=0.7),
    "with twice the amplitude": Maneuver("3211", slew_s=0.3, amplitude_deg=3.0),
    "0.3 s after the mode changed": Maneuver("rev", slew_s=0.2, settling_s=0.3),
    "a second before the next": Maneuver("3211", slew_s=0.3, free_s=1.0, gap_s=0.0),
    "a second after the last": Maneuver("rev", slew_s=0.3, settling_s=0.0),
    "a doublet": Maneuver("doublet", slew_s=0.3),
    "a pulse": Maneuver("pulse", slew_s=0.3),
    "seven smooth steps": Maneuver("multistep", slew_s=0.5, uneven=0.3),
    "a multisine": Maneuver("multisine"),
}
AIRCRAFT = ["uav", pytest.param("light", marks=pytest.mark.study)]
MEASURED = Noise(alpha_deg=0.1, pitch_rate_deg_s=0.2, pitch_deg=0.05, accelerometer_m_s2=0.1)


def heard(flight, name):
    """What the stream tells of a flight."""
    path = FOLDER / f"{name}.tlog"
    record(flight, path)
    return hear_log(path).events


def spans(events):
    return [event.maneuver.span for event in events if isinstance(event, ManeuverFlown)]


@cache
def by_hand(aircraft):
    """Where each of the inputs was flown (boot s), and the manoeuvres that were found."""
    flight = Flight(Scenario(aircraft=aircraft, maneuvers=tuple(HANDS.values()), noise=MEASURED))
    flown = [(BOOT_S + p.start_s, BOOT_S + p.start_s + p.input.duration_s) for p in flight.planned]
    return dict(zip(HANDS, flown, strict=True)), spans(heard(flight, f"hands-{aircraft}"))


@pytest.mark.parametrize("aircraft", AIRCRAFT)
@pytest.mark.parametrize("how", HANDS)
def test_an_input_is_found_however_a_hand_flies_it(aircraft, how):
    flown, found = by_hand(aircraft)
    start_s, end_s = flown[how]
    (span,) = [span for span in found if start_s - 1.0 < span.start_s < end_s]
    assert span.start_s == pytest.approx(start_s, abs=0.8)
    # The last step of seven has a fifth of the amplitude: it may be a trim that differs.
    assert end_s - 1.6 < span.last_step_s < end_s + 0.2
    assert start_s - 2.0 < span.record_from_s <= span.start_s


@pytest.mark.parametrize("aircraft", AIRCRAFT)
def test_hands_find_at_most_one_manoeuvre_that_was_none(aircraft):
    flown, found = by_hand(aircraft)
    assert len(flown) <= len(found) <= len(flown) + 1


@pytest.mark.parametrize("settling_s", [0.1, 0.3, 0.8])
def test_a_record_that_begins_just_before_the_input_will_do(settling_s):
    scenario = Scenario(
        lead_in_s=0.0,
        settling_s=settling_s,
        closing_s=0.0,
        noise=MEASURED,
        maneuvers=(Maneuver("3211", slew_s=0.2, uneven=0.2),),
    )
    (span,) = spans(heard(Flight(scenario), f"short-{settling_s}"))
    assert span.start_s == pytest.approx(BOOT_S + settling_s, abs=0.25)
    assert span.record_from_s == pytest.approx(BOOT_S, abs=0.1)


@pytest.mark.parametrize("slew_s", [0.4, 0.8])
def test_smooth_steps_of_an_unstable_aircraft_are_found(slew_s):
    noise = Noise(alpha_deg=0.05, pitch_rate_deg_s=0.1, pitch_deg=0.05)
    (span,) = spans(heard(unstable_flight(FOLDER, slew_s, noise), f"unstable-{slew_s}"))
    assert span.last_step_s - span.start_s > 7.0


def test_each_input_flown_in_fly_by_wire_is_told_of():
    maneuvers = [Maneuver(name, mode="FBWA", slew_s=slew) for name in ("3211", "rev") for slew in (0.0, 0.4)]
    flight = Flight(Scenario(maneuvers=tuple(maneuvers), noise=MEASURED))
    events = heard(flight, "fbwa")
    told = [(span.start_s, span.end_s) for span in spans(events)]
    told += [(event.start_s, event.end_s) for event in events if isinstance(event, Activity)]
    for planned in flight.planned:
        middle_s = BOOT_S + planned.start_s + 0.5 * planned.input.duration_s
        assert any(start < middle_s < end for start, end in told)
    assert spans(events), "a sharp input in a closed loop is identified"


@pytest.mark.study
@pytest.mark.parametrize("aircraft", ["uav", "light"])
@pytest.mark.parametrize("gusts_m_s", [0.0, 0.5, 1.0])
def test_twenty_minutes_of_ordinary_flying_hold_at_most_one_manoeuvre(aircraft, gusts_m_s):
    """Climbs, turns and changes of speed, all flown by the autopilot."""
    speeds = {"uav": (20.0, 24.0, 28.0), "light": (45.0, 55.0, 60.0)}[aircraft]
    legs = tuple(
        Maneuver(
            "none",
            airspeed_m_s=speeds[k % 3],
            height_m=150.0 + 40.0 * (7 * k % 5),
            bank_deg=(0.0, 20.0, -25.0)[k % 3],
            gap_s=110.0,
            unit_s=0.001,
            settling_s=0.0,
            free_s=0.0,
        )
        for k in range(11)
    )
    scenario = Scenario(
        aircraft=aircraft,
        maneuvers=legs,
        noise=MEASURED,
        air=Air(turbulence_m_s=gusts_m_s),
        rates={**Scenario().rates, "AOA_SSA": 0.0, "RAW_IMU": 0.0, "GLOBAL_POSITION_INT": 0.0},
    )
    events = heard(Flight(scenario), f"ordinary-{aircraft}-{gusts_m_s}")
    assert len(spans(events)) <= 1
    autopilot = [event for event in events if isinstance(event, Activity) and event.reason == "autopilot"]
    assert np.ptp([event.start_s for event in autopilot]) > 600.0
