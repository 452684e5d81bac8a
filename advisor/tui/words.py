"""Sentences shortened for a glance."""

import re


def without_word(sentence: str) -> str:
    """Return a verdict's sentence without its first word, which stands in large letters already."""
    return re.sub(r"^[A-Z ]+: ", "", sentence)


def headline(sentence: str) -> str:
    """Return the text before the first colon or full stop, for a glance."""
    return re.split(r"[:;.](?:\s|$)", sentence, maxsplit=1)[0]
