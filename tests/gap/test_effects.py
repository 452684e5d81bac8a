"""An effect is described in one place, and everything else follows from that description."""

from dataclasses import fields

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import aircraft_schema, parse_aircraft
from advisor.exports.models.improvement import ExportedServo
from advisor.gap.candidates.known import variants_for, with_known
from advisor.gap.effects import EFFECTS
from advisor.gap.inference.posterior import stated_as
from advisor.gap.kit.changes_between import shift_moments
from advisor.gap.kit.effect import ANY, BLOCKS, Effect, Variant
from advisor.gap.records.prepare import prepare
from advisor.gap.result import Cause, Value
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX
from advisor.gap.verdict.statements import what
from advisor.simulators.as_given import added
from advisor.simulators.protocol import State
from benchmarks.pages.planned import PLANS, described
from tests.gap.generator import Setup, fly

NUMBERS = dict(zip(DERIVATIVES, (-2.7, 0.02, -0.15, -23.0, -3.4, -29.0), strict=True))
STATE = State(
    t=0.0, alpha=0.1, alpha_dot=0.0, q=0.2, elevator=0.01, airspeed_m_s=25.0, height_m=300.0, throttle=0.0
)


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_an_effect_lacks_no_part(effect):
    described_in_fits = [v for plan in PLANS for v in described(effect.name, plan)]
    spelled = {name for v in described_in_fits for name in (*(v.in_file or v.names), *v.fixed)}
    assert EFFECTS[effect.name] is effect
    assert effect.block in BLOCKS
    assert effect.said
    assert effect.keys
    assert spelled <= effect.keys.keys()
    assert described_in_fits or effect.outside_fits is not None
    assert {v.block for v in described_in_fits} <= {effect.block}
    assert set(effect.distinguished_by) <= set(EFFECTS)
    assert effect.curve is None or effect.curve.powers.keys() <= effect.keys.keys()
    assert effect.servo.keys() <= effect.keys.keys()
    assert {part for part, _ in effect.servo.values()} <= {one.name for one in fields(ExportedServo)}


def test_an_effect_without_a_part_is_refused():
    with pytest.raises(TypeError, match="said"):
        Effect(name="flap_wake", block="force_equation", keys={"share": ANY}, variants=lambda _: ())


@pytest.fixture
def flap_wake(monkeypatch):
    """A made-up effect: the wake of a flap takes a share of the lift and of the elevator's power."""

    def take(p, values, _):
        p[:, [INDEX["Z_alpha"], INDEX["M_delta_e"]]] *= 1.0 - values[0]

    wake = Variant(
        "flap_wake", "force_equation", ("share",), ((0.0,),), (0.005,), ((-0.5, 0.5),), 0.01, apply_with=take
    )
    made_up = Effect(
        name="flap_wake",
        block="force_equation",
        keys={"share": ANY},
        variants=lambda _: (wake,),
        said="The flap's wake takes {share_percent:.0f} % of the lift",
    )
    monkeypatch.setitem(EFFECTS, "flap_wake", made_up)


@pytest.fixture(scope="module")
def flights():
    return prepare(fly(Setup(maneuvers=2, seed=4)), Aircraft())


@pytest.mark.usefixtures("flap_wake")
def test_a_new_effect_is_searched_for(flights):
    assert [v.names for v in variants_for(flights) if v.effect == "flap_wake"] == [("share",)]


@pytest.mark.usefixtures("flap_wake")
def test_a_new_effect_is_a_row_of_the_evidence():
    assert stated_as("flap_wake").block == "force_equation"


@pytest.mark.usefixtures("flap_wake")
def test_an_aircraft_file_may_have_a_new_effect_and_its_schema_explains_it():
    assert parse_aircraft({"effects": {"flap_wake": {"share": 0.2}}}).effects["flap_wake"]["share"] == 0.2
    schema = aircraft_schema()["properties"]["effects"]["properties"]["flap_wake"]
    assert schema["properties"] == {"share": {"type": "number"}}
    assert schema["description"] == "The flap's wake takes x % of the lift"


@pytest.mark.usefixtures("flap_wake")
def test_a_new_effect_has_its_sentence():
    cause = Cause("flap_wake", "force_equation", 0.9, {"share": Value(0.2, 0.01)}, (), "", 0.0, True)
    assert what(cause) == "The flap's wake takes 20 % of the lift"


@pytest.mark.usefixtures("flap_wake")
def test_a_users_simulator_flies_a_new_effect(flights):
    derivatives = np.array(list(NUMBERS.values()))
    base = np.zeros(len(ENTRIES))
    base[: len(derivatives)] = derivatives
    found = with_known(base, {"flap_wake": {"share": 0.2}}, flights, variants_for(flights))
    flight = flights.flights[0]
    force, moment = added(flights.flights, found, derivatives)[0](STATE)
    ratio = STATE.airspeed_m_s / flight.reference_m_s
    departure = STATE.alpha - flight.alpha_trim
    assert force == pytest.approx(-0.2 * NUMBERS["Z_alpha"] * ratio * departure, rel=1e-9)
    assert moment == pytest.approx(-0.2 * NUMBERS["M_delta_e"] * ratio**2 * STATE.elevator, rel=1e-9)


def test_every_effect_that_some_manoeuvres_show_is_flown_in_more_of_them():
    """As for a simulator's shrink: a search leaves manoeuvres out, and its model flies all."""
    flown = fly(Setup(maneuvers=5, speed_change=0.2, seed=9))
    every, fewer = (prepare(maneuvers, Aircraft()) for maneuvers in (flown, flown[:3]))
    variants = [variant for one in variants_for(fewer) for variant in (one, *one.likewise)]
    assert len(variants) > len(EFFECTS)
    for variant in variants:
        p = np.zeros((5, len(ENTRIES)))
        p[:, [INDEX[name] for name in DERIVATIVES]] = list(NUMBERS.values())
        variant.apply(p, [0.01] * len(variant.names), every)
        assert np.all(np.isfinite(p)), variant.effect


def test_a_wandering_centre_of_gravity_gives_every_force_the_same_further_arm():
    believed, p = np.array([-4.3, -0.03, -0.28, -37.0, -4.8, -52.0]), np.zeros((2, len(ENTRIES)))
    p[:, :6] = believed
    shift_moments(p, np.array([0.0, -0.2]))
    changes = (p[1] - p[0])[[INDEX["M_alpha"], INDEX["M_q"], INDEX["M_delta_e"]]]
    forces = believed[[0, 1, 2]]
    assert changes[0] == pytest.approx(-0.2 * believed[3])
    assert changes / forces == pytest.approx(np.full(3, changes[0] / forces[0]))
