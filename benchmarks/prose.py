"""The prose of the repository: docstrings, strings that are sentences, and pages written by hand."""

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
STYLE = REPOSITORY / "docs" / "developer" / "style.md"
"""The page of the rule, which quotes bad examples."""
_SENTENCE_END = re.compile(
    r"(?:(?<=[.!?])|(?<=[.!?]\*\*))(?<!\be\.g\.)(?<!\bi\.e\.)(?<!Eqs\.)(?<!Eq\.)(?<!\bcf\.)(?<!\bvs\.)\s+(?=[A-Z`*\"“(Δαθ])"
)
_MESSAGE_END = re.compile(rf";\s+|{_SENTENCE_END.pattern}")
"""A message says what is wrong before a semicolon, and the next step after it."""
_PLACEHOLDER = "…"
_GENERATED = "Made by `make"


@dataclass(frozen=True, slots=True)
class Text:
    """A piece of prose, and its place."""

    path: Path
    line: int
    kind: str
    """``function``, ``docstring`` (of a module, class, property or constant), ``string`` or ``page``."""
    owner: str
    """Name of the function, class or constant that the piece describes; empty for any other piece."""
    sentences: tuple[str, ...]


def texts_in(room: Path) -> Iterator[Text]:
    """Yield the prose of a file, or of every file of a folder."""
    for path in sorted(room.rglob("*")) if room.is_dir() else [room]:
        if path.suffix == ".py":
            yield from _python_texts(path)
        elif path.suffix == ".md" and path != STYLE and not _is_generated(path):
            yield from _page_texts(path)


def _is_generated(page: Path) -> bool:
    return _GENERATED in page.read_text(encoding="utf-8")[:400]


def _python_texts(path: Path) -> Iterator[Text]:
    docstrings: set[int] = set()
    inside: set[int] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Module):
            for text, owner, kind in _docstrings(node):
                docstrings.add(id(text))
                yield Text(path, text.lineno, kind, owner, _docstring_sentences(text.value))
        if isinstance(node, ast.JoinedStr):
            inside.update(id(part) for part in ast.walk(node) if part is not node)
        sentence = "" if id(node) in docstrings | inside else _literal(node)
        if _is_sentence(sentence):
            yield Text(path, node.lineno, "string", "", tuple(_MESSAGE_END.split(sentence)))


def _docstrings(node: ast.AST) -> Iterator[tuple[ast.Constant, str, str]]:
    """Yield the docstring of a node, and those of the constants and fields in the node's body."""
    before = node
    for statement in node.body:
        if isinstance(statement, ast.Expr) and _is_text(statement.value):
            yield statement.value, _owner(before), _kind(before)
        before = statement


def _owner(node: ast.AST) -> str:
    if isinstance(node, ast.Assign | ast.AnnAssign):
        return ast.unparse(node.targets[0] if isinstance(node, ast.Assign) else node.target)
    return getattr(node, "name", "")


def _kind(node: ast.AST) -> str:
    decorators = {ast.unparse(d).split("(")[0].split(".")[-1] for d in getattr(node, "decorator_list", ())}
    is_function = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    return "function" if is_function and not decorators & {"property", "cached_property"} else "docstring"


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _literal(node: ast.AST) -> str:
    """Return the text of a string, with a mark in place of each value that is filled in."""
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if _is_text(part) else _PLACEHOLDER for part in node.values)
    return node.value if _is_text(node) else ""


def _is_sentence(text: str) -> bool:
    """Return whether a string is prose: at least five words, most of them of letters alone."""
    words = text.split()
    plain = [word for word in words if re.fullmatch(r"[(“\"']?[A-Za-zäöüé'-]+[).,;:!?”\"']*", word)]
    return len(plain) >= 5 and "\n" not in text.strip() and len(plain) >= 0.7 * len(words)


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
    page = path.read_text(encoding="utf-8")
    page = re.sub(r"```.*?```", lambda code: "\n" * code.group().count("\n"), page, flags=re.S)
    line = 1
    for paragraph in re.split(r"(\n\s*\n)", page):
        if paragraph.strip() and not paragraph.startswith(("    ", "#", "<")):
            prose = re.sub(r"\]\([^)]*\)", "]", paragraph)
            rows = [row.strip() for row in prose.splitlines()]
            parts = [[cell] for row in rows for cell in row.split("|")] if "|--" in prose else [rows]
            yield Text(path, line, "page", "", tuple(s for part in parts for s in _sentences(part)))
        line += paragraph.count("\n")
