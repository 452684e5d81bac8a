"""The pilot's one word of advice, from the campaign's verdicts."""

import re
from dataclasses import dataclass, replace
from typing import Literal

from advisor.session.behind import spoken
from advisor.session.conducting import View

Word = Literal[
    "CONTINUE", "REPEAT", "TEST COMPLETE", "RECOVER", "ENOUGH", "WAIT", "BEHIND", "NO LINK", "NO DATA"
]
Tone = Literal["good", "warn", "bad", "quiet"]


@dataclass(frozen=True, slots=True)
class Advice:
    """Word and sentence of advice for the pilot, with their urgency."""

    word: Word
    sentence: str
    tone: Tone
    age: str = ""
    """Age of the word, for the line below the word; empty if the word is new."""


_OLD = "the verdicts below are that old. The link and its recording go on."


def advise(view: View) -> Advice:
    """Return the most important advice: unusable data, the manoeuvre in flight, or the verdicts.

    The last word stays while the link is lost or this computer is behind, and its age stands below. If the
    estimator does not answer, only RECOVER and TEST COMPLETE stay. After the flight test says stop on each
    tested axis, no further data are needed.
    """
    if view.health.condition == "stale":
        word = _by_verdicts(view, True)
        stays = word.word in ("RECOVER", "TEST COMPLETE")
        return (
            replace(word, age=view.health.sentence) if stays else Advice("WAIT", view.health.sentence, "bad")
        )
    is_old = bool(view.health.behind) or view.health.condition == "lost"
    word = _by_verdicts(view, is_old)
    if not is_old:
        return word
    if view.health.behind:
        none = Advice("BEHIND", f"{view.health.behind.capitalize()}: {_OLD}", "bad")
        age = f"{spoken(view.health.behind_s)} old"
    else:
        none = Advice("NO LINK", f"{view.health.sentence}{_another(view)}", "bad")
        age = f"no link: {view.health.sentence}"
    return replace(word, age=age) if _is_a_word(word, view) else none


def _is_a_word(word: Advice, view: View) -> bool:
    """Return whether the word comes from verdicts. A word from verdicts needs a manoeuvre that is judged or
    in flight.
    """
    return word.word in ("RECOVER", "TEST COMPLETE") or _is_flown(view)


def _is_flown(view: View) -> bool:
    """Return whether a manoeuvre of either axis has been judged."""
    side = view.state.lateral
    return bool(view.state.maneuvers or (side is not None and side.maneuvers))


def _by_verdicts(view: View, is_old: bool) -> Advice:
    """Return the advice of the verdicts. Old data give no advice on a missing channel or vehicle."""
    state, verdict, last = view.state, view.state.flight_test, view.last
    side = state.tested_sideways
    if side is not None:
        verdict, last = side.flight_test, side.maneuvers[-1]
    plan = view.plan
    complete = verdict.decision == "stop" if plan is None else plan.is_complete
    if view.obstacles and not complete and not is_old:
        return Advice("NO DATA", f"{view.obstacles[0]}{_another(view)}{_elevator(view)}", "bad")
    if state.arriving is not None and state.arriving.is_enough:
        return Advice("ENOUGH", "Each derivative of this input is within its tolerance: let go.", "good")
    if complete:
        return Advice("TEST COMPLETE", verdict.sentence, "good")
    if state.is_recorded:
        return Advice("RECOVER", "The free response is recorded: recover.", "good")
    if state.vehicle is None:
        return Advice("WAIT", view.health.sentence, "quiet")
    if not (state.serves or is_old or _is_flown(view)):
        return Advice("WAIT", "The vehicle is heard; its first seconds of data are awaited.", "quiet")
    if state.judging and not _is_flown(view):
        return Advice("WAIT", "The first manoeuvre is being judged.", "quiet")
    sentence = plan.sentence if plan is not None and verdict.decision == "stop" else verdict.sentence
    if last and not last.verdict.accepted and last.maneuver.span.is_test_input:
        return Advice("REPEAT", sentence, "warn")
    return Advice("CONTINUE", sentence, "quiet")


def _another(view: View) -> str:
    """Return a sentence on vehicles that a key selects; empty after the first manoeuvre and in replays."""
    others = view.state.other_vehicles
    if not others or view.state.maneuvers or view.tempo is not None:
        return ""
    return f" Vehicle {', '.join(map(str, others))} is heard: key v follows another."


def _elevator(view: View) -> str:
    """Return a sentence on the keys that choose an unknown elevator output on a live link."""
    if view.obstacles[0].code != "no_elevator" or view.tempo is not None:
        return ""
    guess = view.state.elevator_guess
    return (
        f" {str(guess).capitalize()}; key g takes it."
        if guess
        else " Key a asks the vehicle for its elevator output."
    )


def without_word(sentence: str) -> str:
    """Return a verdict's sentence without its first word, which is already shown in large letters."""
    return re.sub(r"^[A-Z ]+: ", "", sentence)
