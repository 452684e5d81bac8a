"""A verdict that changes has a sentence of its own, with the reason."""

from advisor.decision.heard import revision
from advisor.decision.verdict import ManeuverVerdict, Reason

ACCEPTED = ManeuverVerdict(True, "ACCEPTED: good manoeuvre", (), {})


def refused(text):
    return ManeuverVerdict(False, f"REPEAT: {text}", (Reason("odd", text, 9.0, 6.0),), {})


ODD = refused("contradicts all the others, 9.0 sigma from them (limit 6.0); fly it again")


def test_a_verdict_that_stays_has_no_sentence():
    assert revision(ACCEPTED, ACCEPTED, 6) == ""
    assert revision(ODD, ODD, 6) == ""


def test_an_acceptance_that_is_taken_back_names_the_objection():
    said = revision(ACCEPTED, ODD, 6)
    assert said.startswith(
        "accepted before, refused since manoeuvre 6: contradicts all the others, 9.0 sigma"
    )


def test_a_refusal_that_is_taken_back_names_what_no_longer_holds():
    assert revision(ODD, ACCEPTED, 6) == (
        "refused before, accepted since manoeuvre 6: it no longer contradicts all the others, 9.0 sigma from "
        "them (limit 6.0)"
    )
    said = revision(refused("bank reached 60 deg (limit 45); less aileron"), ACCEPTED, 7)
    assert said.endswith("it no longer counts against it that bank reached 60 deg (limit 45)")
