"""Check the English of docstrings, messages and pages against ``docs/developer/style.md``.

    python -m benchmarks.english [ROOM ...] [--list]
    python -m benchmarks.english --sample 40 --read --seed 1 [ROOM ...]

A room is a file or a folder of the repository. The command reads the prose of ``benchmarks.prose``. The
command prints a count for each room and fails where a room has more findings than ``ALLOWED``, whose limits
only fall. With ``--list`` every finding is printed. With ``--sample`` sentences are drawn at random, so that
a reader can judge each one; ``--read`` leaves out docstrings, which no user reads.
"""

import argparse
import random
import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from benchmarks.prose import REPOSITORY, Text, texts_in

ROOMS = ("advisor", "sim", "README.md", "CONTRIBUTING.md", "SECURITY.md", "docs")
MOST_WORDS = 25
"""Most words of one sentence. A longer sentence holds more than one fact."""
ALLOWED = {
    "advisor/gap": 4,
    "advisor/words": 1,
    "advisor/model": 1,
    "advisor/oem": 5,
    "advisor/bundled": 1,
    "docs": 7,
}
"""Room to the number of findings that its text still has. A room without a limit has none."""
PHRASES = {
    r"\btold as\b": "say: diagnosed as, reported as",
    r"\bbeside\b": "say: next to, relative to, in addition to",
    r"\bfrom (?:\S+ ){1,3}on(?=[.,;:)]|$)": "say: at least x, after x",
    r"\bof itself\b": "say: alone, without a request",
    r"\bthe same of\b|\bas of\b": "name the quantity again",
    r"\bleftovers?\b|\b(?:the|its|no|a) remainder\b": "say: residual, rest",
    r"\b(?:companions?(?! computer)|amid|unrest|strangeness)\b": "use the word of the field",
    r"\bties\b": "say: bounds between parameters, equal values",
    r"\b(?:its|the|their|of) worth\b|\bworth of\b": "say: information, hold-out gain, value",
    r"\bbeliefs?\b": "say: prior, model file",
}
OPENINGS = {
    r"the same\b": "name the thing again: 'the same' stands elsewhere",
    r"what\b": "name the thing instead of 'what'",
    r"it\b": "name the subject instead of 'it'",
    r"as (?!long|soon|if|many|much)": "say the fact, not a comparison with another docstring",
}
_NO_VERB = re.compile(
    r"(?:the|an?|whether|how|where|why|which|whose?|when|one|two|three|every\w*|all|nothing|of|for|another|each"
    r"|no|as|per|from|share (?:of|by)|mean|shape|ratio|median|root|power|largest|smallest"
    r"|(?!note that)\w+ (?:of|that|whose))\b|[(-]",
    re.IGNORECASE,
)
"""Openings of a docstring that has no verb in front. A function's docstring begins with an imperative."""


def main() -> int:
    """Print findings or a sample; return 1 where a room has more findings than allowed."""
    parser = argparse.ArgumentParser(description="Check the English of the project.")
    parser.add_argument("rooms", nargs="*", default=ROOMS, help="files or folders of the repository")
    parser.add_argument("--list", action="store_true", help="print every finding")
    parser.add_argument("--sample", type=int, metavar="N", help="print N sentences drawn at random")
    parser.add_argument("--read", action="store_true", help="sample only what users read: messages and pages")
    parser.add_argument("--seed", type=int, default=0, help="seed of the sample")
    options = parser.parse_args()
    texts = [text for room in options.rooms for text in texts_in(REPOSITORY / room)]
    if options.read:
        texts = [text for text in texts if text.kind in ("string", "page")]
    if options.sample:
        _print_sample(texts, options.sample, options.seed)
        return 0
    found = [(text, finding) for text in texts for finding in findings(text)]
    if options.list:
        for text, finding in found:
            print(f"{text.path.relative_to(REPOSITORY)}:{text.line}: {finding}")
    counts = Counter(_room(text.path) for text, _ in found)
    for room in sorted(counts):
        limit = ALLOWED.get(room, 0)
        verdict = "  ABOVE: see --list" if counts[room] > limit else ""
        print(f"{room:24s}{counts[room]:6d}  limit {limit}{verdict}")
    return int(any(count > ALLOWED.get(room, 0) for room, count in counts.items()))


def findings(text: Text) -> Iterator[str]:
    """Yield one line for every breach of the rule in a text."""
    for sentence in text.sentences:
        if (count := len(sentence.split())) > MOST_WORDS:
            yield f"{count} words: {sentence[:90]}"
        for pattern, advice in PHRASES.items():
            if match := re.search(pattern, sentence, re.IGNORECASE):
                yield f"'{match.group()}' ({advice}): {sentence[:90]}"
    if text.kind in ("page", "string") or not text.sentences:
        return
    first = text.sentences[0]
    for pattern, advice in OPENINGS.items():
        if re.match(pattern, first, re.IGNORECASE):
            yield f"{advice}: {first[:90]}"
    if text.kind == "function" and _NO_VERB.match(first):
        yield f"begin with a verb (Return, Read, Write ...): {first[:90]}"


def _room(path: Path) -> str:
    parts = path.relative_to(REPOSITORY).parts
    return "/".join(parts[:2]) if parts[0] == "advisor" and len(parts) > 2 else parts[0]


def _is_whole(text: Text, sentence: str) -> bool:
    """Return whether a sentence can be judged: no cell of a table, no command, at least four words."""
    return len(sentence.split()) >= 4 and (text.kind != "page" or sentence.endswith((".", "!", "?", ":")))


def _print_sample(texts: list[Text], count: int, seed: int) -> None:
    sentences = [(text, s) for text in texts for s in text.sentences if _is_whole(text, s)]
    for number, (text, sentence) in enumerate(random.Random(seed).sample(sentences, count), start=1):
        place = f"{text.path.relative_to(REPOSITORY)}:{text.line}"
        print(f"{number:2d}. {sentence}\n    ({text.kind} {text.owner}, {place})")


if __name__ == "__main__":
    sys.exit(main())
