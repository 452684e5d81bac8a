"""The diagnosis on a terminal: everything fits, sizes have units, nothing rests on colour."""

import io
import shlex
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.alternative import Alternative, AlternativeEvidence, Contribution
from advisor.gap.result import Cause, Diagnosis, Gap, Shrink, Trace, Unseen, Value, Where, Yardsticks
from advisor.report.facts.sizes import in_units, short, sizes_of, with_error
from advisor.report.gap_causes import confusion_sentence
from advisor.report.gap_document import GapStep, next_steps
from advisor.report.gap_screen import GapScreen, command_lines

CHANNELS = ("alpha", "q", "a_z", "theta")
DELAY = Cause(
    "transport_delay", "input", 0.93, {"delay_s": Value(0.03035, 0.006)}, ("actuator_lag",),
    "log the measured surface position", 0.21, True,
)  # fmt: skip
CURVED = Cause(
    "nonlinear_pitching_moment", "moment_equation", 0.04,
    {"M_alpha2": Value(171.3, 5.2), "M_alpha3": Value(-3891.0, 131.0)}, (), "", 3.2,
)  # fmt: skip
UNLIKELY = Cause(
    "elevator_nonlinearity", "moment_equation", 0.002, {"M_delta2": Value(1.0, 1.0)}, (), "", 9.0
)


EVIDENCE = (
    AlternativeEvidence(Alternative("effect", "transport_delay", "input"), (), 0.818),
    AlternativeEvidence(Alternative("effect", "actuator_lag", "input"), (), 0.18),
    AlternativeEvidence(Alternative("unknown", "unknown", "force_equation"), (), 0.002),
)


def diagnosis(**changes: object) -> Diagnosis:
    """Return a diagnosis with as large numbers and as long names as there are."""
    t = np.linspace(0.0, 9.0, 300)
    fit = (Yardsticks(0.123, 0.01, 0.02, 0.97, 0.8123, 0.55), Yardsticks(0.012, 0.0, 0.0, 1.0, 0.9999, 1.0))
    content: dict[str, object] = {
        "verdict": "effect", "sentence": "The simulator answers 30 ms too early.",
        "gap": Gap(
            12345.6, 0.21, dict.fromkeys(CHANNELS, 0.01), "measured", dict.fromkeys(CHANNELS, 123456.7),
            dict.fromkeys(CHANNELS, 0.0123), ((1, 2.0, 0.1), (2, 5.0, 0.2), (12, 123456.7, 2.2e-16)),
            {"step edge": 234567.8, "plateau": 3.4, "free response": 0.0},
            ((0.0, 0.5, 0.25), (4.0, 10.0, 0.75)),
        ),
        "where": Where("input", 0.97, (("input", 1.0), ("pitch_rate_sensor", 0.4))),
        "causes": (DELAY, CURVED, UNLIKELY), "shrink": Shrink((1, 2, 3), 12345.6, 0.21, 99.9, (99.0, 100.0)),
        "waterfall": (("nonlinear_pitching_moment", 3.2), ("transport_delay", 0.21)),
        "cannot_see": (
            Unseen("ground_effect", "the height above ground did not change", "fly low and high"),
            Unseen("alpha_bias", "no climb rate", "VFR_HUD at 10 Hz"),
        ),
        "kinematics": KinematicCheck("consistent", "alpha follows the motion."), "model": {},
        "reference_airspeed_m_s": 25.0, "effects": {}, "share_irreducible": 0.8,
        "yardsticks": dict.fromkeys(CHANNELS, fit),
        "traces": tuple(Trace(2, c, t, np.sin(t), np.sin(t - 0.1), np.sin(t)) for c in CHANNELS),
    }  # fmt: skip
    return Diagnosis(**{**content, **changes})  # type: ignore[arg-type]


def printed(found, columns, why=False, steps=(), everything=True):
    """Return the screen as plain text, line by line."""
    out = io.StringIO()
    Console(file=out, width=columns, color_system=None, highlight=False).print(
        GapScreen(found, "better.yaml", why, steps, everything)
    )
    return out.getvalue().splitlines()


def test_why_sets_the_answer_against_its_rival_with_the_odds_of_the_sum():
    reasons = (
        Contribution("fit_gain", 2.0, "gain in the fit: 9 against 4"),
        Contribution("rest", -0.5, "rest"),
    )
    found = diagnosis(why=reasons, answer=EVIDENCE[0].alternative, rival="actuator_lag", evidence=EVIDENCE)
    lines = printed(found, 100, why=True)
    assert any("why transport delay, and not actuator lag" in line for line in lines)
    assert any("+2.0  gain in the fit: 9 against 4" in line for line in lines)
    assert any("−0.5  rest" in line for line in lines)
    assert any("+1.5  together: 4.5 to 1 for the answer" in line for line in lines)


def test_the_box_says_how_sure_the_answer_is_without_alternatives_of_0_percent():
    text = " ".join(printed(diagnosis(evidence=EVIDENCE), 140))
    assert "Probability: transport delay 82 % (by this flight alone 82 %), actuator lag 18 %." in text


@pytest.mark.parametrize("columns", [80, 140])
def test_nothing_is_cut_off_and_no_line_is_longer_than_the_terminal(columns):
    lines = printed(diagnosis(), columns)
    assert max(map(len, lines)) <= columns
    assert not any("…" in line for line in lines)
    assert any("123,457 → 0.0123" in line for line in lines)
    assert any("0.8123 → 0.9999" in line for line in lines)


def test_the_largest_numbers_of_the_fidelity_fit_80_columns():
    poor = Yardsticks(0.999, 0.33, 0.33, 0.34, -12.3456, 1.0)
    gap = replace(diagnosis().gap, by_channel=dict.fromkeys(CHANNELS, 1.23e7))
    lines = printed(diagnosis(gap=gap, yardsticks=dict.fromkeys(CHANNELS, (poor, poor))), 80)
    assert sum("1.23e+07 → 0.0123" in line and "100 → 100" in line for line in lines) == len(CHANNELS)
    assert not any("…" in line for line in lines)


def test_where_in_the_flight_the_gap_lies_has_phases_beside_frequencies_with_bars():
    lines = printed(diagnosis(), 80)
    (edge,) = [line for line in lines if "step edge" in line]
    assert edge.split() == [
        "│",
        "step",
        "edge",
        "234,568",
        "█" * 12,
        "0",
        "to",
        "0.5",
        "Hz",
        "25",
        "%",
        "███",
        "│",
    ]
    (plateau,) = [line for line in lines if "plateau" in line]
    assert plateau.split() == ["│", "plateau", "3.4", "4", "to", "10", "Hz", "75", "%", "█" * 9, "│"]


def test_every_manoeuvre_has_its_gap_before_and_after():
    (row,) = [line for line in printed(diagnosis(), 80) if "2 → 0.1 " in line]
    assert row.split()[1:] == ["1", "2", "→", "0.1", "12", "█" * 12, "123,457", "→", "0", "│"]


def test_a_gap_smaller_than_the_noise_has_no_long_bar():
    quiet = replace(
        diagnosis().gap, by_phase={"plateau": 0.04}, by_maneuver=((1, 0.03, 0.03),), by_band_hz=()
    )
    lines = printed(diagnosis(gap=quiet, verdict="none", causes=(), waterfall=(), shrink=None), 80)
    between = lines[lines.index(next(x for x in lines if "where in the flight" in x)) : -1]
    assert not any("██" in line for line in between)


def test_the_interval_of_the_shrink_encloses_it_as_printed():
    shrunk = Shrink((1, 2, 3), 100.0, 0.1, 99.9, (99.86, 99.94))
    (line,) = [line for line in printed(diagnosis(shrink=shrunk), 80) if "% less" in line]
    assert line.startswith("99.9 % less (95 %: 99.9 to 99.9)")


@pytest.mark.parametrize(("after", "beside"), [(0.452, ", both below the noise"), (1.25, "")])
def test_a_gap_that_grows_on_held_out_manoeuvres_is_no_negative_shrink(after: float, beside: str):
    grown = Shrink((1, 3), 0.0956, after, -372.8, (-372.8, -20.3))
    lines = printed(diagnosis(shrink=grown), 140)
    assert f"larger on held-out manoeuvres 1, 3: 0.0956 → {after}{beside}" in lines
    assert "% less" not in " ".join(lines)


def test_an_answer_that_changes_nothing_has_no_larger_gap():
    grown = replace(diagnosis().gap, by_maneuver=((1, 0.1, 0.3),))
    text = " ".join(printed(diagnosis(gap=grown, verdict="none", causes=(), shrink=None), 140))
    assert "larger" not in text


def test_a_shrink_of_other_gaps_than_those_above_it_states_its_own():
    shrunk = Shrink((2, 5), 16.3, 1.98, 87.8, (87.4, 88.3))
    assert "manoeuvres 2, 5; the corrections alone leave 1.98" in " ".join(
        printed(diagnosis(shrink=shrunk), 140)
    )
    assert "the corrections alone" not in " ".join(printed(diagnosis(), 140))


def test_the_error_says_that_its_size_is_shown_and_an_interval_that_it_holds_95_percent():
    text = " ".join(printed(diagnosis(), 140))
    assert "the one with the largest gap (absolute value)" in text
    assert text.count("±: 95 %") == 1


def test_a_cause_takes_a_line_with_its_size_in_units_people_use():
    (line,) = [line for line in printed(diagnosis(), 80) if "transport delay" in line and "93 %" in line]
    assert line.startswith("●")
    assert "30 ± 12 ms" in line
    assert line.endswith("0.21")


def test_what_a_cause_is_tied_with_is_a_sentence():
    assert confusion_sentence(DELAY) == (
        "Transport delay cannot be distinguished from actuator lag here. "
        "To distinguish them, log the measured surface position."
    )


def test_causes_below_one_per_cent_share_a_line():
    assert "Below 1 %: elevator nonlinearity." in printed(diagnosis(), 80)


def test_the_guilty_block_is_marked_without_colour():
    (row,) = [line for line in printed(diagnosis(), 80) if "COMMAND" in line]
    assert "▶ COMMAND → SURFACE ◀" in row
    assert "[pitch rate] 40 %" in row


def test_a_block_as_good_as_the_marked_one_is_explained():
    where = Where("input", 0.97, (("input", 1.0), ("timing", 0.999), ("moment_equation", 0.4)))
    lines = printed(diagnosis(where=where), 80)
    assert any("[time stamps] 100 %" in line for line in lines)
    assert any("can hardly distinguish the two" in line for line in lines)
    assert any("how well a block would explain the gap on its own" in line for line in lines)
    assert not any("hardly distinguish" in line for line in printed(diagnosis(), 80))


def test_another_block_with_a_cause_is_marked_and_has_no_per_cent():
    second = replace(CURVED, present=True)
    where = Where("input", 0.97, (("input", 1.0), ("moment_equation", 1.0)))
    lines = printed(diagnosis(where=where, causes=(DELAY, second)), 80)
    (row,) = [line for line in lines if "COMMAND" in line]
    assert "[pitching moment] ●" in row
    assert not any("100 %" in line for line in lines[4:10])


def test_no_block_is_guilty_when_there_is_no_gap():
    lines = printed(diagnosis(verdict="none", causes=(), waterfall=(), shrink=None), 80)
    assert not any("▶" in line for line in lines)


def test_without_all_the_largest_answer_takes_at_most_40_lines():
    decided = (replace(EVIDENCE[0], probability=0.99),)
    found = diagnosis(evidence=decided, causes=(DELAY, CURVED, UNLIKELY))
    steps = next_steps(found, ["flight-of-the-long-wing.tlog"], "long-wing-with-a-name.yaml")
    lines = printed(found, 80, steps=steps, everything=False)
    assert len(lines) <= 40
    text = " ".join(" ".join(lines).split())
    for part in (
        "CAUSE FOUND",
        "where: between the command",
        "● transport delay",
        "Add to what the file states",
    ):
        assert part in text
    assert "--all adds the gap in time and by manoeuvre, the fidelity by channel, 2 notes and 2 eff" in text


def test_a_command_over_several_lines_is_one_to_a_shell():
    command = "advisor gap 'my flight.tlog' --aircraft mine.yaml --out mine-with-transport-delay.yaml"
    lines = command_lines(command, 40)
    assert len(lines) > 1
    assert max(map(len, lines)) <= 40
    assert shlex.split("\n".join(lines).replace("\\\n", "")) == shlex.split(command)


def test_no_blank_follows_the_backslash_of_a_printed_command():
    steps = [GapStep("Prove the change.", f"advisor gap {'flight-of-the-long-wing.tlog ' * 4}--json")]
    lines = [one for one in printed(diagnosis(), 80, steps=steps) if "\\" in one]
    assert lines
    assert all(one.endswith("\\") for one in lines)


def test_effects_that_share_a_reason_share_a_row():
    first, second = (Unseen(name, "no vane", "a vane") for name in ("alpha_lag", "alpha_scale"))
    lines = printed(diagnosis(cannot_see=(first, diagnosis().cannot_see[0], second)), 120)
    assert "  alpha lag, alpha scale  no vane → a vane" in [line.rstrip() for line in lines]


def test_what_the_flight_could_not_show_takes_a_line_an_effect():
    lines = printed(diagnosis(), 120)
    assert "  alpha bias     no climb rate → VFR_HUD at 10 Hz" in [line.rstrip() for line in lines]
    assert any(line.startswith("  ground effect") for line in lines)


@pytest.mark.parametrize(
    ("parameter", "value", "std", "text"),
    [
        ("delay_s", 0.03035, 0.006, "30 ± 12 ms"),
        ("lag_s", 0.10374, 0.0113, "104 ± 22 ms"),
        ("half_width_rad", 0.00873, 0.00035, "0.500 ± 0.039 deg"),
        ("bias_rad_s", -0.01553, 0.0023, "−0.89 ± 0.26 deg/s"),
        ("scale", 0.117, 0.004, "+11.70 ± 0.78 %"),
        ("arm_m", 0.31, 0.02, "0.310 ± 0.039 m"),
        ("M_alpha3", -3891.0, 131.0, "−3891 ± 257 s⁻²rad⁻²"),
        ("at_s", 327.0, 0.0, "327 s"),
    ],
)
def test_sizes_have_units_and_the_digits_of_their_interval(parameter, value, std, text):
    assert with_error(parameter, Value(value, std)) == text


def test_several_sizes_of_one_cause_are_named():
    assert [line.split()[0] for line in sizes_of(CURVED.parameters)] == ["M_α²", "M_α³"]


def test_a_parameter_that_only_says_that_something_is_so_is_put_in_words():
    sizes = {"skew_s": Value(0.06, 0.002), "with_pitch_rate": Value(1.0, 0.0)}
    assert sizes_of(sizes) == ["+60.0 ± 3.9 ms", "the pitch rate, too"]


@pytest.mark.parametrize(
    "parameter", ["change", "share", "rate_per_s", "sigma_w_m_s", "frequency_hz", "gain"]
)
def test_every_parameter_of_a_cause_has_a_unit(parameter):
    assert in_units(parameter)[1]


def test_thousands_are_written_out():
    assert short(12345.6) == "12,346"
    assert short(0.01234) == "0.0123"


def test_what_is_as_good_as_nothing_is_written_so():
    assert short(2.22e-16) == short(0.0) == "0"
    assert short(0.0004) == "<0.001"


def test_without_a_gap_no_block_is_pointed_at_and_fitted_numbers_are_no_improvement():
    shrunk = Shrink((1, 2, 3), 100.0, 0.1, 99.9, (99.86, 99.94))
    lines = printed(diagnosis(verdict="none", shrink=shrunk, waterfall=()), 80, everything=False)
    assert any(line.strip() == "gap 12,346 times the noise floor's power" for line in lines)
    assert not any("% less" in line or "gap after" in line for line in lines)
    assert not any("[pitching moment]" in line for line in lines)
    assert any("[pitching moment]" in line for line in printed(diagnosis(), 80))
