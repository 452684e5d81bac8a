"""Natural widths from kept evidence: weighing, learning, and the score on the generator left out."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from advisor.gap.inference.residual import NATURAL, Residual
from benchmarks.learn_nature import __main__ as command
from benchmarks.learn_nature.evidence import GRID, KeptFlight, KeptRow, evidence_rows
from benchmarks.learn_nature.learning import learnt, left_out_each
from benchmarks.learn_nature.weighing import LEAST_SHARE, Widths, log_normal_of, log_score, probabilities

IN_USE = Widths.in_use()


def flight(size: float, right: str, generator: str = "own", natural: tuple[float, ...] = ()) -> KeptFlight:
    """Return a flight with one right row and one lacking row, whose residual has a size."""
    rows = (
        KeptRow("none", 0.0, size, size, lacks=False, natural=natural),
        KeptRow("unknown", -2.0, size, size, lacks=True),
    )
    kind = {"none": "none", "unknown": "outside"}[right]
    return KeptFlight(generator, f"{generator}/{size}", kind, (right,), rows)


def test_the_density_of_a_size_gives_back_its_mean_and_deviation() -> None:
    assert log_normal_of(lambda x: -0.5 * ((np.log(x) - 1.2) / 0.7) ** 2 - np.log(0.7)) == pytest.approx(
        (1.2, 0.7)
    )


def test_the_widths_in_use_are_those_of_the_diagnosis() -> None:
    for size in (0.5, 1.0, 3.0, 8.0):
        right, lacking = (IN_USE.density(row) for row in flight(size, "none").rows)
        if_right, if_lacking = Residual(size, {}).nats(in_moving_air=False)
        assert lacking - right == pytest.approx(if_lacking - if_right)


def test_a_larger_residual_makes_a_law_without_a_name_likelier() -> None:
    small, large = (probabilities(flight(size, "none"), IN_USE)["unknown"] for size in (1.0, 9.0))
    assert small < 0.1 < 0.9 < large


def test_a_wider_natural_residual_takes_probability_from_the_unknown() -> None:
    wider = replace(IN_USE, natural=3.0 * IN_USE.natural)
    one = flight(4.0, "none")
    assert probabilities(one, wider)["none"] > probabilities(one, IN_USE)["none"] + 0.3


def test_a_natural_effect_of_another_size_moves_the_row_that_has_it() -> None:
    natural = tuple(float(np.log(factor)) for factor in GRID)
    doubled = replace(IN_USE, effects=2.0)
    row = flight(1.0, "none", natural=natural).rows[0]
    assert doubled.weight(row) - IN_USE.weight(row) == pytest.approx(np.log(2.0))


def test_data_sheets_weigh_the_residual_by_their_own_size() -> None:
    row = replace(flight(6.0, "none").rows[0], sheet_size=1.0)
    by_sheets = replace(IN_USE, by_data_sheets=True)
    assert by_sheets.density(row) == pytest.approx(IN_USE.density(replace(row, size=1.0)))


def test_the_log_score_of_an_excluded_truth_is_that_of_one_in_a_thousand() -> None:
    assert log_score(flight(40.0, "none"), IN_USE) == pytest.approx(np.log(LEAST_SHARE))


def test_widths_follow_flights_whose_right_models_leave_twice_the_residual() -> None:
    rng = np.random.default_rng(4)
    clean = [flight(float(np.exp(rng.normal(np.log(2.5), 0.4))), "none") for _ in range(40)]
    lacking = [flight(float(np.exp(rng.normal(np.log(9.0), 0.6))), "unknown") for _ in range(20)]
    wide = learnt([*clean, *lacking], IN_USE)
    assert wide.natural > 1.4 * NATURAL
    assert np.mean([log_score(f, wide) for f in clean]) > np.mean([log_score(f, IN_USE) for f in clean])


def test_widths_stay_where_no_flight_speaks() -> None:
    assert learnt([], IN_USE).vector == pytest.approx(IN_USE.vector, abs=0.05)


def test_a_generator_is_left_out_of_the_widths_that_it_is_scored_with() -> None:
    own = [flight(1.0, "none"), flight(3.0, "unknown")]
    other = [flight(6.0, "none", "second"), flight(9.0, "unknown", "second")]
    on_all = learnt([*own, *other], IN_USE)
    rows = list(left_out_each([*own, *other], IN_USE, on_all, IN_USE))
    assert [row.generator for row in rows] == ["own", "second"]
    assert rows[1].on_others == pytest.approx(
        np.mean([log_score(f, learnt(own, IN_USE)) for f in other]), abs=1e-9
    )
    assert rows[1].lost > 0.0


def test_a_kept_flight_is_read_back_as_it_was() -> None:
    kept = flight(2.0, "none", natural=(0.0,) * len(GRID))
    assert KeptFlight.of(json.loads(json.dumps(kept.document()))) == kept


def test_the_command_learns_from_kept_evidence_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "FOLDER", tmp_path)
    flights = [flight(1.0, "none"), flight(5.0, "unknown"), flight(1.5, "none", "second")]
    (tmp_path / "7.jsonl").write_text("".join(json.dumps(f.document()) + "\n" for f in flights))
    said = CliRunner().invoke(command.main, ["--seed", "7", "--table"])
    assert said.exit_code == 0
    assert "set on all" in said.output
    assert "left out" in said.output


def test_a_seed_without_evidence_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "FOLDER", tmp_path)
    said = CliRunner().invoke(command.main, ["--seed", "8", "--table"])
    assert said.exit_code == 2
    assert "leave out --table" in said.output


def test_a_diagnosis_without_a_posterior_leaves_no_evidence() -> None:
    assert evidence_rows(lambda: None) == ()


@pytest.mark.study
def test_evidence_of_a_recorded_flight_has_the_probabilities_of_its_posterior() -> None:
    from advisor.aircraft_file.read import load_aircraft
    from advisor.analysis.gap import compare_logs

    log = Path("logs/arduplane-calm.tlog")
    diagnoses = []
    rows = evidence_rows(
        lambda: diagnoses.append(compare_logs([log], load_aircraft(log.with_suffix(".yaml"))))
    )
    (compared,) = diagnoses
    kept = KeptFlight("real", "calm", "one", ("actuator_lag",), rows)
    each = probabilities(kept, IN_USE)
    answer = compared.diagnosis.answer
    assert answer is not None
    assert max(each, key=lambda name: each[name]) == answer.name
