"""The diagnosis of roll and yaw: decisions on results made by hand, and one whole flight."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Beta, SideControl
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.gap.alternative import Alternative, AlternativeEvidence, together
from advisor.gap.axis import diagnosis
from advisor.gap.axis import flight as flight_of_axis
from advisor.gap.axis.diagnosis import _capped, diagnose_axis, where_of
from advisor.gap.axis.evidence import Squares
from advisor.gap.axis.fit import Fit, Point
from advisor.gap.axis.flight import AxisFlight, AxisModel
from advisor.gap.axis.measure import measured, sums
from advisor.gap.axis.models import case_of
from advisor.gap.axis.setting import Flown
from advisor.gap.inference.engine import Decided
from advisor.gap.inference.explanation import Evidence, Row
from advisor.gap.inference.posterior import NONE, PARAMETERS, posterior_of
from advisor.gap.inference.stage import Stage
from advisor.gap.result import Cause, Diagnosis, Gap, Shrink, Value, Where
from advisor.gap.verdict.text import answers_of
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.parameter import Parameter
from advisor.oem.axis.problem import AxisProblem
from advisor.oem.extra import Prior
from advisor.oem.rows import Signal
from advisor.report.gap_document import axis_document, gap_document
from benchmarks.lateral_gap import CASES, diagnosed
from tests.gap.axis.test_comparison import maneuvers
from tests.gap.test_report_screen import printed
from tests.maneuvers import changed
from tests.oem.axis.builders import JET
from tests.schemas import breaches

PEAKS = {"p": 0.2, "r": 0.1}
PLAY = Cause(
    "actuator_backlash", "input", 0.7, {"half_width_rad": Value(0.01, 0.001)}, (), "", 0.5, True,
    "aileron", "aileron actuator backlash", "The real aileron has play of 0.57 deg to either side",
    Value(30.0, 4.0), {"p": 0.05, "r": 0.04},
)  # fmt: skip


def weighed(shares):
    """Return probabilities by label as the evidence of a diagnosis."""
    kinds = {"none": "none", "parameters": "parameters"}
    told = []
    for label, p in shares.items():
        name, _, block = label.partition("@")
        kind = "unknown" if block else kinds.get(name, "effect")
        told.append(AlternativeEvidence(Alternative(kind, name, block), (), p))
    answer = together((one.alternative, one.probability) for one in told)[0][0]
    return {"evidence": tuple(told), "answer": answer}


FOUND = Diagnosis(
    axis="lateral", verdict="effect", sentence=PLAY.sentence,
    where=Where("aileron", 1.0, (("aileron", 1.0),)),
    causes=(PLAY,), peaks={"simulator": PEAKS, "fitted_derivatives": PEAKS}, model={}, maneuvers=(1, 2, 3),
    gap=Gap(
        3.0, 0.5, {"p": 0.01}, "measured", {"p": 3.0}, {"p": 0.5},
        ((1, 3.0, 0.5), (2, 2.0, 0.4), (3, 4.0, 0.6)),
    ),
    shrink=Shrink((1, 2, 3), 3.0, 0.5, 83.3, (80.0, 86.0)),
    **weighed(
        {"aileron_actuator_backlash": 0.7, "none": 0.2, "parameters": 0.05, "aileron_actuator_lag": 0.05}
    ),
)  # fmt: skip


def test_the_blocks_of_the_unknown_count_together_and_the_likeliest_is_the_place():
    shares = {
        "unknown@rolling_moment": 0.35, "actuator_lag": 0.3, "unknown@aileron": 0.2, "none": 0.1,
        "parameters": 0.05,
    }  # fmt: skip
    where = where_of(LATERAL, weighed(shares)["evidence"], ())
    assert (where.block, where.share) == ("rolling_moment", pytest.approx(0.35 / 0.55))
    said = diagnosis._sentence("unknown", where, ())
    assert said == "Something acts in the rolling moment that no known effect explains."


def test_the_place_of_an_effect_is_that_of_its_control_or_sensor():
    places = [where_of(LATERAL, (), [replace(PLAY, of=of)]).block for of in ("aileron", "p")]
    assert places == ["aileron", "roll_rate_sensor"]


def test_the_screen_says_the_cause_with_its_control_its_size_and_its_place():
    text = "\n".join(printed(FOUND, 100))
    assert "The real aileron has play of 0.57 deg to either side" in text
    assert "● aileron actuator backlash    70 %   0.57 ± 0.11 deg" in text
    assert "▶ AILERON ◀" in text
    assert "nothing to correct 20" in text


def test_without_a_simulator_the_screen_has_neither_probabilities_nor_a_gap_before_and_after():
    instruments = {"rudder_lag_s": Value(0.06, 0.003), "airspeed_excess": Value(0.03, 0.01)}
    worse = replace(FOUND.gap, before=0.2)
    alone = replace(FOUND, verdict="untested", gap=worse, instruments=instruments)
    text = "\n".join(printed(alone, 100, why=True))
    assert axis_document(alone)["how_sure"] == ""
    assert axis_document(FOUND)["how_sure"]
    assert "NOTHING TO COMPARE WITH" in text
    assert "wrong numbers" not in text
    assert "aileron actuator backlash" not in text
    assert "before" not in text
    assert "▲" not in text
    assert "Nuisance parameters of the fit, which are not part of the answer:" in text
    assert "rudder lag 60.0 ± 5.9 ms" in text
    assert "airspeed excess 3.0 ± 2.0 %" in text


def test_an_undecided_answer_is_not_decided_in_the_document_and_has_the_flight_that_separates_the_two():
    shares = {"none": 0.5, "aileron_actuator_backlash": 0.45, "parameters": 0.05}
    document = axis_document(replace(FOUND, verdict="none", **weighed(shares)))
    assert document["decided"] is False
    assert document["title"] == "NOT DECIDED BETWEEN NOTHING TO CORRECT AND AILERON ACTUATOR BACKLASH"
    (step,) = document["next"]
    assert step["text"].startswith(
        "To separate nothing to correct from aileron actuator backlash: fly the same"
    )
    assert axis_document(FOUND)["decided"] is True
    assert axis_document(FOUND)["next"] == []


def test_the_document_has_probabilities_that_sum_to_one_and_the_gain_on_unseen_manoeuvres():
    document = axis_document(FOUND)
    told = document["probabilities"]
    assert told["none"] + told["parameters"] + sum(told["effects"].values()) == pytest.approx(1.0)
    (cause,) = document["causes"]
    assert (cause["of"], cause["effect"], cause["block"]) == ("aileron", "actuator_backlash", "input")
    assert cause["held_out_nats"] == {"value": 30.0, "std": 4.0}
    assert document["peaks"]["simulator"] == PEAKS


def diagnosed_with(reading):
    """Return the diagnosis of a flight whose roll rate is read by a function of the true one: about 8 s."""
    known = SideControl(lag_s=0.0, delay_s=0.0)
    aircraft = Aircraft(aileron=known, rudder=known, beta=Beta("none"), model=dict(JET))
    flight = [changed(m, "p", y=reading(m.channels["p"].y)) for m in maneuvers()]
    return diagnose_axis(
        case_of(LATERAL, flight, aircraft, np.array([JET[name] for name in SIDE_PARAMETERS]))
    )


@pytest.mark.study
def test_a_gyro_that_reads_too_much_is_named_with_its_size():
    found = diagnosed_with(lambda p: 1.08 * p)
    assert found.verdict == "effect"
    first = found.causes[0]
    assert first.name == "roll_rate_scale"
    assert first.parameters["scale"].value == pytest.approx(0.08, abs=0.02)
    assert first.sentence.startswith("The roll rate reads 8")
    assert first.peaks["p"] < found.peaks["simulator"]["p"]


@pytest.mark.study
def test_a_gyro_that_clips_is_a_law_without_a_name_in_its_channel():
    found = diagnosed_with(lambda p: np.clip(p, -0.6 * np.max(np.abs(p)), 0.6 * np.max(np.abs(p))))
    assert found.verdict == "unknown"
    assert found.where.block == "roll_rate_sensor"
    assert answers_of(found.evidence)[0][1] > 0.6


@pytest.mark.study
@pytest.mark.parametrize(
    ("effect", "size", "named"),
    [("p_scale", 0.0951, "roll_rate_scale"), ("r_skew", 0.0587, "late_yaw_rate_stamps")],
)
def test_an_effect_is_named_in_side_gusts_too(effect, size, named):
    gusts = {CASES["side_turbulence"].parameter: 0.25}
    found = diagnosed(11, {effect: {CASES[effect].parameter: size}, "side_turbulence": gusts})
    assert found.verdict == "effect"
    assert found.causes[0].name == named


@pytest.mark.study
def test_side_gusts_alone_are_no_delay_of_a_surface():
    found = diagnosed(12, {"side_turbulence": {CASES["side_turbulence"].parameter: 0.24}})
    assert answers_of(found.evidence)[0][0] == "side gusts"


def test_two_effects_at_once_are_both_said_and_stand_before_the_alternatives():
    lag = replace(PLAY, of="rudder", named="rudder actuator lag", sentence="The real rudder lags by 60 ms")
    other = replace(PLAY, named="roll rate scale", present=False, probability=0.1, gap_after=np.nan)
    causes = PLAY, lag, other
    assert diagnosis._sentence("effect", Where(), causes) == f"{PLAY.sentence}. The real rudder lags by 60 ms"
    waterfall = ("aileron_actuator_backlash", 0.4), ("rudder_actuator_lag", 0.0)
    document = axis_document(replace(FOUND, causes=causes, waterfall=waterfall))
    assert [cause["present"] for cause in document["causes"]] == [True, True, False]
    assert document["waterfall"][0] == {"effect": "aileron_actuator_backlash", "after": 0.4}
    assert [cause["gap_after"] for cause in document["causes"]] == [0.5, 0.5, None]


def test_effects_that_set_the_same_number_are_never_two_causes():
    first, same, elsewhere = (
        SimpleNamespace(places=((of, "scale"),), name=name)
        for of, name in (("p", "a"), ("p", "b"), ("r", "c"))
    )
    assert flight_of_axis._beside(SimpleNamespace(effect=first), [first, same, elsewhere]) == [elsewhere]


def test_an_effect_changes_what_a_late_command_does_so_that_its_slope_is_taken_anew(monkeypatch):
    late = Parameter(("aileron", "delay_s"), Prior(0.0, 0.01), step=1e-3, column=np.ones(3))
    fit = Fit(
        None, None, (late,), *(np.ones(3) for _ in range(2)), 0.0, *(np.ones((3, 1)) for _ in range(3)), None
    )
    again = []
    monkeypatch.setattr(flight_of_axis, "colour_share", lambda *_, **__: 1.0)
    monkeypatch.setattr(flight_of_axis, "Starts", lambda *_, **__: SimpleNamespace(of_each=[]))
    monkeypatch.setattr(AxisFlight, "_model", lambda *_: side_model(fit))
    case = SimpleNamespace(stated=(), natural=(), fit=lambda at, free, **_: again.extend(free) or fit)
    AxisFlight(case, fit, []).explained(SimpleNamespace(fit=fit, effect=None), 3)
    assert [one.column for one in again] == [None]


class TwoOptima:
    """A case with two plain fits, each the likelier one by ``heights`` at the temperature of one of them."""

    stated, natural, flown, axis = (), (), None, LATERAL

    def __init__(self, heights):
        self.heights = heights
        self.fits = [
            SimpleNamespace(
                point=Point(np.zeros(1), np.zeros((1, 1)), {("rudder", "lag_s"): np.zeros(1)}),
                free=(),
                of=k,
                share=share,
                likelihood=1.0,
            )
            for k, share in enumerate((1.0, 0.5))
        ]

    def fit(self, at, free, tolerance=0.3, share=1.0):
        self.fits.reverse()
        return self.fits[0]

    def prior_of(self, tolerance, free, share=1.0):
        return SimpleNamespace(height=lambda fit: self.heights(fit, share))


def searched(monkeypatch, heights):
    """Return the plain model's fit after the search among two optima, and the parts that failed."""
    case = TwoOptima(heights)
    start = SimpleNamespace(name="lag", price=0.0)
    monkeypatch.setattr(flight_of_axis, "colour_share", lambda fit, **_: fit.share)
    monkeypatch.setattr(flight_of_axis, "Starts", lambda *_, **__: SimpleNamespace(of_each=[start]))
    monkeypatch.setattr(flight_of_axis, "base_of", lambda *_: np.zeros(1))
    lag = SimpleNamespace(places=(("rudder", "lag_s"),))
    monkeypatch.setattr(
        AxisFlight, "_model", lambda self, effect, fit, *_: replace(side_model(fit), effect=effect)
    )
    monkeypatch.setattr(
        AxisFlight, "_added", lambda self, start, at, *_: replace(side_model(at, 1.0), effect=lag)
    )
    side = AxisFlight(case, case.fits[0], [])
    _, (plain, *_) = side.explained(None, 1)
    return plain.fit, side.parts.failed


def test_two_plain_fits_are_compared_at_one_temperature_so_that_the_search_ends(monkeypatch):
    """Each optimum is the likelier at the temperature of the other: two temperatures take turns for ever."""
    fit, failed = searched(monkeypatch, lambda fit, share: 10.0 * (fit.share != share))
    assert (fit.share, failed) == (0.5, ())


def test_a_search_without_an_end_stops_and_is_reported(monkeypatch):
    """Every other search finds something likelier still."""
    heights = iter(range(0, 10000, 100))
    _, (failed,) = searched(monkeypatch, lambda fit, share: -next(heights))
    assert failed.part == "roll and yaw, search of the derivatives alone"
    assert "4 searches" in str(failed.problem)


@pytest.mark.parametrize(("right", "wrong", "fitted"), [(5.0, 0.0, False), (0.0, 5.0, True)])
def test_a_model_is_fitted_at_the_files_derivatives_only_where_others_are_likelier(right, wrong, fitted):
    found = SimpleNamespace(point=None, free=())
    one = SimpleNamespace(evidence=Evidence(right, wrong), fit=found, effect=None, starts=None)
    again = []
    case = SimpleNamespace(natural=(), fit=lambda *given: again.append(given))
    assert AxisFlight(case, None, []).at_the_files(one, None, 1.0) is None
    assert bool(again) is fitted


def side_model(fit, nats=0.0, alternative=None):
    told = {"fit": fit, "evidence": Evidence(nats, nats), "natural": Evidence(nats, nats), "likelihood": nats}
    return AxisModel(**dict.fromkeys(AxisModel.__dataclass_fields__) | told | {"alternative": alternative})


@pytest.mark.parametrize(("nats", "likeliest"), [(30.0, "with an effect"), (0.0, "plain")])
def test_the_air_is_weighed_in_the_residual_of_the_likeliest_explanation(monkeypatch, nats, likeliest):
    of, still = [], SimpleNamespace(likelihood=0.0)
    monkeypatch.setattr(flight_of_axis, "gusts_of", lambda fit, *_: of.append(fit) or still)
    monkeypatch.setattr(flight_of_axis, "coloured_likelihood", lambda _: 0.0)
    monkeypatch.setattr(flight_of_axis, "within_model_error", lambda _, everyone, error: everyone)
    monkeypatch.setattr(AxisFlight, "_wide", lambda *_: None)
    monkeypatch.setattr(AxisFlight, "_blown", lambda self, one, *_: one)
    plain, other = (SimpleNamespace(name=name, linear=lambda _: None) for name in ("plain", "with an effect"))
    stage = Stage(side_model(plain), (side_model(other, nats),), (), 1.0)
    AxisFlight(SimpleNamespace(flown=None, axis=LATERAL), plain, []).in_moving_air(stage)
    assert [fit.name for fit in of] == [likeliest]


@pytest.mark.parametrize(
    ("maneuvers", "gap", "stated", "answer", "chosen"),
    [
        (2, 0.0, ["L_p"], "none", 1),
        (2, 1.9, ["L_p"], "none", 1),
        (2, 10.0, ["L_p"], "parameters", 1),
        (2, 10.0, [], "unknown", 1),
        (1, 10.0, ["L_p"], "none", 2),
    ],
)
def test_no_gap_is_unlikely_beside_a_visible_gap_of_held_out_manoeuvres(
    monkeypatch, maneuvers, gap, stated, answer, chosen
):
    """Fitted derivatives remove the whole gap, which without stated ones they are no part of.

    One manoeuvre is held out of nothing.
    """
    lag = Alternative("effect", "actuator_lag", "input")
    rows = [Row(NONE, None, {"fit": 9.0}), Row(PARAMETERS, None, {"fit": 0.0}), Row(lag, None, {"fit": 1.0})]
    rows.append(Row(Alternative("unknown", "unknown", "aileron"), None, {"fit": 0.0}))
    models = (side_model(SimpleNamespace(residual=1.0)), side_model(None, 0.0, lag))
    left = 0.0 if maneuvers > 1 else np.nan
    monkeypatch.setattr(diagnosis, "measured", lambda *_: (SimpleNamespace(before=gap, after=left), None))
    monkeypatch.setattr(diagnosis, "sums", lambda *_: None)
    monkeypatch.setattr(diagnosis, "_held_out", lambda *_: None)
    monkeypatch.setattr(diagnosis, "_as_given", lambda *_: models[0].fit)
    case = SimpleNamespace(numbers=(), stated=stated)
    found = _capped(case, Decided((posterior_of(rows),), models, (), 1.0))
    assert found.posteriors[0].answer.kind == answer
    assert len(found.chosen) == chosen


@pytest.mark.parametrize(("saved", "named"), [(1.0, []), (9.0, [("r", "p")])])
def test_a_pair_counts_where_it_makes_up_for_the_second_effects_share_of_the_prior(saved, named):
    """One of four effects has a share of 1.4 nats, 2.8 of the cost."""
    p, r, *others = (SimpleNamespace(name=name, places=((name, "scale"),)) for name in "prab")
    starts = SimpleNamespace(
        of_each=[SimpleNamespace(name=one.name, price=100.0) for one in (p, r)],
        together=lambda one, other: 100.0 - saved,
    )
    pairs = AxisFlight(None, None, [p, r, *others]).pairs(
        SimpleNamespace(plain=SimpleNamespace(starts=starts)), [SimpleNamespace(name="r", effect=r)]
    )
    assert [names for _, *names in pairs] == [list(pair) for pair in named]


@pytest.mark.parametrize(("angle", "kind"), [(1e-4, "none"), (0.05, "air")])
def test_gusts_far_above_the_natural_ones_are_the_answer_of_a_flight_with_nothing_else(angle, kind):
    row = Row(NONE, SimpleNamespace(gusts=SimpleNamespace(angle=angle)), {})
    assert diagnosis._named_air(LATERAL, row).alternative.kind == kind


def test_a_second_cause_is_as_probable_as_both_together(monkeypatch):
    stages = [SimpleNamespace(of=lambda _, p=p: p, by_alternative={}) for p in (0.9, 0.5)]
    model = SimpleNamespace(alternative="an effect", name="lag")
    found = SimpleNamespace(posteriors=stages, chosen=(None, model, model), heat=1.0)
    monkeypatch.setattr(diagnosis, "_cause", lambda case, one, told, p, present: p)
    told = diagnosis._causes(None, found, None, None)
    assert list(told) == [pytest.approx(0.9), pytest.approx(0.45)]


def test_the_gap_of_an_output_and_of_a_manoeuvre_is_the_mean_square_error_over_the_noise_minus_one():
    owner, channel = np.array([0, 0, 0, 0, 1, 1]), np.array([1, 1, 2, 2, 1, 1])
    laid = SimpleNamespace(maneuvers=2, owner=owner, channel=channel, axis=LATERAL, least=LATERAL.least)
    error, noise = np.array([0.1, 0.1, 0.3, 0.3, 0.2, 0.2]), np.array([0.0, 0.05, 0.1, 0.1, 0.1])
    fit = SimpleNamespace(assembly=laid, noise=noise, residual=error)
    after = sums(fit, 0.25 * error**2)
    gap, shrink = measured(fit, (4, 7), sums(fit, error**2), after)
    assert gap.by_channel == {"r": pytest.approx(9.0), "bank": pytest.approx(8.0)}
    assert gap.by_channel_after == {"r": pytest.approx(1.5), "bank": pytest.approx(1.25)}
    assert (gap.before, gap.after) == (pytest.approx(8.5), pytest.approx(1.375))
    first, second = gap.by_maneuver
    assert first == (4, pytest.approx((3.0 + 8.0) / 2.0), pytest.approx((0.0 + 1.25) / 2.0))
    assert second == (7, pytest.approx(15.0), pytest.approx(3.0))
    assert shrink.percent == pytest.approx(100.0 * (1.0 - 1.375 / 8.5))
    after[0] = np.nan
    gap, shrink = measured(fit, (4, 7), sums(fit, error**2), after)
    assert (gap.by_channel["r"], shrink.holdout) == (pytest.approx(15.0), (7,))
    gap, shrink = measured(fit, (4, 7), sums(fit, error**2), np.full_like(after, np.nan))
    assert (gap.before, np.isnan(gap.after), shrink) == (pytest.approx(8.5), True, None)


@pytest.mark.parametrize(("records", "kept"), [("ar", 0), ("aar", 2), ("aarr", 4), ("a", 0), ("aa", 2)])
def test_a_manoeuvre_that_alone_moves_a_control_is_not_held_out(monkeypatch, records, kept):
    """A letter is a manoeuvre of the aileron or the rudder."""
    moved = Signal(np.arange(2.0), np.array([0.0, 0.1]))
    flown = [SimpleNamespace(inputs={{"a": "aileron", "r": "rudder"}[one]: moved}) for one in records]
    problem = AxisProblem(LATERAL, tuple(flown))
    monkeypatch.setattr(diagnosis, "information_of", lambda *_: None)
    told = SimpleNamespace(held_out=np.zeros((len(records), 1)))
    monkeypatch.setattr(diagnosis, "squares_of", lambda *_: told)
    case = SimpleNamespace(flown=Flown(problem, ()), prior_of=lambda *_: None)
    model = SimpleNamespace(fit=SimpleNamespace(free=()), tolerance=0.3)
    assert np.count_nonzero(~np.isnan(diagnosis._held_out(case, model, 1.0))) == kept


def test_an_effect_loses_nothing_on_a_manoeuvre_that_only_the_prior_predicts(monkeypatch):
    """The manoeuvre that alone moves the rudder is predicted a hundred times worse with the effect."""
    moved = Signal(np.arange(2.0), np.array([0.0, 0.1]))
    flown = [SimpleNamespace(inputs={of: moved}) for of in ("aileron", "aileron", "rudder")]
    flight = Flown(AxisProblem(LATERAL, tuple(flown)), ())
    case = SimpleNamespace(flown=flight, prior_of=lambda *_: None, axis=LATERAL)
    effect = SimpleNamespace(
        variant=SimpleNamespace(bounds=((-1.0, 1.0),), names=()), sides=None, of="aileron", name="lag"
    )
    laid = SimpleNamespace(maneuvers=3, owner=np.repeat([0, 1, 2], 9), channel=np.zeros(27, int))
    plain, fit = (SimpleNamespace(assembly=laid, noise=np.ones(1), residual=r, free=(), likelihood=0.0)
                  for r in (np.ones(27), 0.5 * np.ones(27)))  # fmt: skip
    squares = {id(plain): [[9.0], [9.0], [9.0]], id(fit): [[4.0], [4.0], [900.0]]}

    def of_each(one, *_):
        told = np.array(squares[id(one)])
        return Squares(np.minimum(told, 4.0) if one is fit else told, told)

    nothing = SimpleNamespace(matrix=np.zeros((1, 1, 1)), gradient=np.zeros((1, 1)))
    monkeypatch.setattr(flight_of_axis, "squares_of", of_each)
    monkeypatch.setattr(flight_of_axis, "information_of", lambda *_: tuple(vars(nothing).values()))
    monkeypatch.setattr(flight_of_axis, "within_bounds", lambda _, information, __: (information, 0.0))
    monkeypatch.setattr(flight_of_axis, "step_of", lambda *_: np.zeros(1))
    monkeypatch.setattr(flight_of_axis, "change_of", lambda *_: 0.1)
    side = AxisFlight(case, plain, [effect])
    monkeypatch.setattr(AxisFlight, "_weighed", lambda *_: (Evidence(0.0, 0.0),) * 2)
    assert side._model(effect, fit, plain, 1.0).unseen == 0.0


def test_each_manoeuvre_has_its_gap_before_and_after():
    (one, *_) = axis_document(FOUND)["gap"]["by_maneuver"]
    assert one == {"number": 1, "before": 3.0, "after": 0.5}


def test_a_gap_of_which_nothing_is_held_out_has_no_value_after():
    alone = replace(FOUND.gap, after=np.nan, by_channel_after={"p": np.nan})
    document = axis_document(replace(FOUND, gap=alone, shrink=None))
    found = document["gap"]
    assert (found["before"], found["after"], found["by_channel_after"]) == (3.0, None, {"p": None})
    assert found["text"] == "gap 3 times the noise floor's power; no manoeuvre can be held out"
    assert document["shrink"] is None


def test_the_schema_explains_every_key_of_roll_and_yaw():
    assert breaches("gap", gap_document(FOUND)) == []


def test_roll_and_yaw_have_every_key_of_pitch():
    assert axis_document(FOUND).keys() >= gap_document(None).keys() - {
        "schema",
        "usable",
        "problems",
        "exports",
    }
