"""Certainty of an answer: its title, and the sentence that names two undecided answers."""

from collections.abc import Sequence

DECIDED = 0.6
"""Contract: least probability of an answer that is considered decided."""
_SURE = 0.9
"""Contract: least probability of an answer that is stated without the word "likely"."""

Answers = Sequence[tuple[str, float]]
"""Answers in words with their probabilities, the likeliest first."""


def is_decided(answers: Answers) -> bool:
    """Return whether the likeliest answer is decided; False without probabilities."""
    return bool(answers) and answers[0][1] >= DECIDED


def title(stated: str, likely: str, answers: Answers) -> str:
    """Return the title above an answer.

    Parameters
    ----------
    stated, likely
        Title of the likeliest answer if that answer is certain, and title if the answer is only likely.
    """
    if len(answers) > 1 and not is_decided(answers):
        return f"NOT DECIDED BETWEEN {answers[0][0]} AND {answers[1][0]}".upper()
    return stated if not answers or answers[0][1] >= _SURE else likely


def doubt_of(answers: Answers) -> str:
    """Return the sentence on the two likeliest answers; empty if one answer is decided."""
    if len(answers) < 2 or is_decided(answers):
        return ""
    (first, p), (second, q) = answers[:2]
    return f"Not decided between {first} ({100.0 * p:.0f} %) and {second} ({100.0 * q:.0f} %)."


def as_sure(sentence: str, answers: Answers) -> str:
    """Return the sentence of an answer with its certainty. A likely answer begins with "Likely"; an undecided
    answer becomes the sentence of `doubt_of`.
    """
    if not answers or answers[0][1] >= _SURE:
        return sentence
    return doubt_of(answers) or f"Likely, {sentence[:1].lower()}{sentence[1:]}"
