"""Held parameters and added terms: what the command line and the aircraft file accept."""

import numpy as np
import pytest

from advisor.aircraft.added_term import parse_term
from advisor.aircraft.aircraft import Estimation
from advisor.aircraft_file.estimation import structure_of
from advisor.aircraft_file.read import parse_aircraft
from advisor.words.problems import ConfigurationError

FUNCTIONS = {"abs": np.abs, "sin": np.sin, "cos": np.cos}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("M:q*abs(q)", -4.0),
        ("M:-q + 2*V/(1 - q**2)", 2.0 + 2.0 * 30.0 / -3.0),
        ("Z:sin(q)**2 + cos(q)**2", 1.0),
        ("Z:V**-1", 1.0 / 30.0),
    ],
)
def test_the_factor_of_a_term_is_its_expression(text, value):
    assert parse_term(text).factor({"q": -2.0, "V": 30.0}, FUNCTIONS) == pytest.approx(value)


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("q*q", "no EQUATION:EXPRESSION"),
        ("X:q", "'X' is no equation"),
        ("M:", "no EQUATION:EXPRESSION"),
        ("M:((", "is no expression"),
        ("M:speed", "'speed' is no signal"),
        ("M:exp(q)", "'exp' is no function"),
        ("M:__import__('os')", "'__import__' is no function"),
        ("M:q.real", "'q.real' is not allowed"),
        ("M:[q][0]", "'[q][0]' is not allowed"),
        ("M:q if q else V", "is not allowed"),
        ("M:q**V", "'V' is no exponent"),
        ("M:q**99999", "'99999' is no exponent"),
        ("M:abs(q, V)", "is not allowed"),
        ("M:q*True", "'True' is not allowed"),
        ("M:3", "names no signal"),
        ("M:" + "-" * 300 + "q", "letters"),
    ],
)
def test_what_is_no_term_is_refused_by_name(text, named):
    with pytest.raises(ValueError, match="^.*" + named.replace("*", r"\*").replace("[", r"\[")):
        parse_term(text)


def test_a_parameter_without_a_value_is_held_at_the_files_model():
    assert structure_of(["M_q"], [], Estimation(), {"M_q": -2.0}).fixed == {"M_q": -2.0}


def test_a_value_of_the_command_line_overrides_the_files():
    assert structure_of(["M_q=-3"], [], Estimation({"M_q": -1.0}), {"M_q": -2.0}).fixed == {"M_q": -3.0}


@pytest.mark.parametrize(
    ("fix", "said"),
    [
        ("M_q", "the aircraft file's model has no M_q; give the value"),
        ("M_x=1", "'M_x' is no parameter"),
        ("M_q=fast", "'fast' is no number"),
        ("M_q=nan", "nan is no value"),
        ("M_q=", "there is no value"),
    ],
)
def test_a_parameter_that_cannot_be_held_is_refused_with_the_next_step(fix, said):
    with pytest.raises(ConfigurationError, match=said):
        structure_of([fix], [], Estimation(), {})


def test_a_term_that_the_model_has_already_is_refused_unless_its_parameter_is_held():
    with pytest.raises(ConfigurationError, match="M_alpha is that term already"):
        structure_of([], ["M:alpha"], Estimation(), {})
    assert structure_of(["M_alpha=-5"], ["M:alpha"], Estimation(), {}).terms == ("M:alpha",)


def test_a_term_is_added_once():
    with pytest.raises(ConfigurationError, match="there already"):
        structure_of([], ["M:q*abs(q)", "M: q * abs(q)"], Estimation(), {})


def test_the_aircraft_file_names_its_mistakes_by_their_path():
    content = {"estimation": {"fixed": {"M_x": 1.0}, "terms": ["M:exp(q)"]}}
    with pytest.raises(ConfigurationError, match=r"estimation\.fixed\.M_x: .*estimation\.terms\[0\]: 'exp'"):
        parse_aircraft(content)
