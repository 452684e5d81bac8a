"""Check the English of docstrings, messages and pages against ``docs/developer/style.md``.

    python -m benchmarks.english [ROOM ...] [--list]
    python -m benchmarks.english --sample 40 --seed 1 [ROOM ...]

A room is a file or a folder of the repository. The command reads docstrings of modules, classes, functions
and constants, strings that are sentences, and pages written by hand. The command prints a count for each
room and fails where a room has more findings than ``ALLOWED``, whose limits only fall. With ``--list`` every
finding is printed. With ``--sample`` sentences are drawn at random, so that a reader can judge each one.
"""

import argparse
import ast
import random
import re
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
STYLE = REPOSITORY / "docs" / "developer" / "style.md"
"""The page of the rule, which quotes bad examples."""
ROOMS = ("advisor", "sim", "README.md", "docs")
MOST_WORDS = 25
"""Most words of one sentence. A longer sentence holds more than one fact."""
ALLOWED = {
    "README.md": 11,
    "advisor": 47,
    "advisor/batch": 15,
    "advisor/campaign": 38,
    "advisor/commands": 34,
    "advisor/decision": 145,
    "advisor/doctor": 37,
    "advisor/exporting": 25,
    "advisor/flight": 276,
    "advisor/gap": 654,
    "advisor/mavlink": 208,
    "advisor/mends": 29,
    "advisor/model": 8,
    "advisor/oem": 170,
    "advisor/report": 105,
    "advisor/simulators": 62,
    "advisor/study": 49,
    "advisor/tui": 130,
    "docs": 184,
    "sim": 78,
}
"""Room to the number of findings that its text still has. A room without a limit has none."""
PHRASES = {
    r"\btold as\b": "say: diagnosed as, reported as",
    r"\bbeside\b": "say: next to, relative to, in addition to",
    r"\bfrom (?:\S+ ){1,3}on(?=[.,;:)]|$)": "say: at least x, after x",
    r"\bof itself\b": "say: alone, without a request",
    r"\bthe same of\b|\bas of\b": "name the quantity again",
    r"\bleftovers?\b|\b(?:the|its|no|a) remainder\b": "say: residual, rest",
    r"\b(?:companions?|amid|unrest|strangeness)\b": "use the word of the field",
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
_SENTENCE_END = re.compile(
    r"(?<=[.!?])(?<!\be\.g\.)(?<!\bi\.e\.)(?<!Eq\.)(?<!\bcf\.)(?<!\bvs\.)\s+(?=[A-Z`*\"“(Δαθ])"
)
_MESSAGE_END = re.compile(rf";\s+|{_SENTENCE_END.pattern}")
"""A message says what is wrong before a semicolon, and the next step after it."""
_PLACEHOLDER = "X"
_GENERATED = "Made by `make"


@dataclass(frozen=True, slots=True)
class Text:
    """A piece of prose, and where the piece stands."""

    path: Path
    line: int
    kind: str
    """``function``, ``docstring`` (of a module, class, property or constant), ``string`` or ``page``."""
    sentences: tuple[str, ...]


def main() -> int:
    """Print findings or a sample; return 1 where a room has more findings than allowed."""
    parser = argparse.ArgumentParser(description="Check the English of the project.")
    parser.add_argument("rooms", nargs="*", default=ROOMS, help="files or folders of the repository")
    parser.add_argument("--list", action="store_true", help="print every finding")
    parser.add_argument("--sample", type=int, metavar="N", help="print N sentences drawn at random")
    parser.add_argument("--seed", type=int, default=0, help="seed of the sample")
    options = parser.parse_args()
    texts = [text for room in options.rooms for text in texts_in(REPOSITORY / room)]
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


def texts_in(room: Path) -> Iterator[Text]:
    """Yield the prose of a file, or of every file of a folder."""
    for path in sorted(room.rglob("*")) if room.is_dir() else [room]:
        if path == STYLE:
            continue
        if path.suffix == ".py":
            yield from _python_texts(path)
        elif path.suffix == ".md" and _GENERATED not in path.read_text(encoding="utf-8")[:400]:
            yield from _page_texts(path)


def _python_texts(path: Path) -> Iterator[Text]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    docstrings: set[int] = set()
    inside: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Module):
            for statement in node.body:
                if isinstance(statement, ast.Expr) and _is_text(statement.value):
                    docstrings.add(id(statement.value))
                    kind = _kind(node) if statement is node.body[0] else "docstring"
                    yield Text(path, statement.lineno, kind, _docstring_sentences(statement.value.value))
        if id(node) in docstrings or id(node) in inside:
            continue
        if isinstance(node, ast.JoinedStr):
            inside.update(id(part) for part in ast.walk(node))
        sentence = _literal(node)
        if _is_sentence(sentence):
            yield Text(path, node.lineno, "string", tuple(_MESSAGE_END.split(sentence)))


def _kind(node: ast.AST) -> str:
    decorators = {ast.unparse(d).split("(")[0].split(".")[-1] for d in getattr(node, "decorator_list", ())}
    is_function = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    return "function" if is_function and not decorators & {"property", "cached_property"} else "docstring"


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _literal(node: ast.AST) -> str:
    """Return the text of a string, with a letter in place of each value that is filled in."""
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if _is_text(part) else _PLACEHOLDER for part in node.values)
    return node.value if _is_text(node) else ""


def _is_sentence(text: str) -> bool:
    """Return whether a string is prose: at least five words, most of them of letters alone."""
    words = text.split()
    plain = [word for word in words if re.fullmatch(r"[(“\"']?[A-Za-zäöüé'-]+[).,;:!?”\"']*", word)]
    return len(words) >= 5 and "\n" not in text.strip() and len(plain) >= 0.7 * len(words)


def _docstring_sentences(docstring: str) -> tuple[str, ...]:
    """Return the sentences of a docstring, without code, rules and names of parameters."""
    found: list[str] = []
    for paragraph in re.split(r"\n\s*\n", ast.get_docstring(ast.parse(repr(docstring))) or ""):
        if not paragraph.startswith(("    ", "\b")):
            found += _sentences(paragraph.splitlines())
    return tuple(found)


def _sentences(lines: Iterable[str]) -> list[str]:
    """Return the sentences of a paragraph, whose parts begin where the indentation or a list says so."""
    parts: list[str] = []
    depth = -1
    for line in lines:
        indent = len(line) - len(line.lstrip())
        if indent == depth and not re.match(r"\s*([-*]|\d+\.) ", line) and parts:
            parts[-1] += " " + line.strip()
        else:
            parts.append(line.strip())
        depth = indent
    prose = [part for part in parts if len(part.split()) > 1 and not re.search(r"-{4,}", part)]
    return [sentence for part in prose for sentence in _SENTENCE_END.split(part)]


def _page_texts(path: Path) -> Iterator[Text]:
    page = re.sub(
        r"```.*?```", lambda m: "\n" * m.group().count("\n"), path.read_text(encoding="utf-8"), flags=re.S
    )
    line = 1
    for paragraph in re.split(r"(\n\s*\n)", page):
        if paragraph.strip() and not paragraph.startswith(("    ", "#", "<")):
            prose = re.sub(r"\]\([^)]*\)", "]", paragraph)
            cells = (
                [cell for row in prose.splitlines() for cell in row.split("|")] if "|--" in prose else None
            )
            texts = (
                [s for cell in cells for s in _sentences([cell])] if cells else _sentences(prose.splitlines())
            )
            yield Text(path, line, "page", tuple(texts))
        line += paragraph.count("\n")


def _room(path: Path) -> str:
    parts = path.relative_to(REPOSITORY).parts
    return "/".join(parts[:2]) if parts[0] == "advisor" and len(parts) > 2 else parts[0]


def _print_sample(texts: list[Text], count: int, seed: int) -> None:
    sentences = [
        (text, sentence) for text in texts for sentence in text.sentences if len(sentence.split()) >= 4
    ]
    for number, (text, sentence) in enumerate(random.Random(seed).sample(sentences, count), start=1):
        print(f"{number:2d}. {sentence}\n    ({text.path.relative_to(REPOSITORY)}:{text.line}, {text.kind})")


if __name__ == "__main__":
    sys.exit(main())
