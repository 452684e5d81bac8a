"""Sentences shortened for a glance."""

import re


def without_word(sentence: str) -> str:
    """Return a verdict's sentence without its first word, which stands in large letters already."""
    return re.sub(r"^[A-Z ]+: ", "", sentence)
