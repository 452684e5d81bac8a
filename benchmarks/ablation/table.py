"""The table of an ablation: what each rule takes in code, and what its absence does to verdicts."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmarks.ablation.corpus import Corpus, right
from benchmarks.ablation.instrument import ROOM, is_constant, module_files, rules_in
from benchmarks.ablation.tally import Count, Tally

_HEAD = (
    "| rule | lines | constants | spoke in | answered without | flips | per thousand "
    "| wrong without | right without |",
    "|---|---|---|---|---|---|---|---|---|",
)


@dataclass(frozen=True)
class Size:
    """What goes with a rule."""

    lines: int
    """Of the function and of private names that nothing else uses."""
    constants: int


def sizes() -> dict[str, Size]:
    """Size of every rule of ``advisor.gap``, by name; of one that says yes or no, by both forced answers."""
    found = {}
    for path in module_files():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        module = path.relative_to(ROOM).with_suffix("").as_posix()
        for name, function, kind in rules_in(tree):
            for forced in (" = False", " = True") if kind == "bool" else ("",):
                found[f"{module}:{name}{forced}"] = _size(tree, function)
    return found


def _size(tree: ast.Module, rule: ast.FunctionDef) -> Size:
    """The rule, and all private names that only it needs, directly or not."""
    defined = {name: node for node in tree.body for name in _names(node)}
    goes: list[ast.stmt] = [rule]
    more = True
    while more:
        inside = {id(part) for node in goes for part in ast.walk(node)}
        used_elsewhere = {
            n.id for n in ast.walk(tree)
            if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load) and id(n) not in inside
        }  # fmt: skip
        new = [
            node for name, node in defined.items()
            if name.startswith("_") and name not in used_elsewhere and node not in goes
        ]  # fmt: skip
        goes, more = [*goes, *new], bool(new)
    constants = sum(is_constant(name) for node in goes for name in _names(node))
    return Size(sum((node.end_lineno or node.lineno) - node.lineno + 1 for node in goes), constants)


def _names(node: ast.stmt) -> list[str]:
    """Names that a statement of a module defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    return [n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]


def table(corpus: Corpus, raw: Path, note: str) -> str:
    """The table as Markdown; ``note`` says when, and of which commit and seeds."""
    tally = Tally(corpus.keys())
    tally.read(raw)
    answered = len(tally.answers)
    were_right = sum(right(tally.keys[case], found) for case, found in tally.answers.items())
    lines = ["# Verdicts of the gap diagnosis without one rule", "", note, ""]
    lines.append(f"{answered} flights, {were_right} answered rightly with all rules.")
    return "\n".join([*lines, "", *_HEAD, *_rows(tally.counts, answered)]) + "\n"


def _rows(counts: dict[str, Count], answered: int) -> Iterator[str]:
    """Rules that were taken out, or never spoke; those with the fewest flips first."""
    known = sizes()
    silent = {rule: Count() for rule in known if rule not in counts and not rule.endswith(" = True")}
    shown = silent | {rule: count for rule, count in counts.items() if count.tried}
    for rule, count in sorted(shown.items(), key=lambda pair: (pair[1].per_thousand(answered), pair[0])):
        size = known.get(rule, Size(0, 0))
        yield (
            f"| `{rule}` | {size.lines} | {size.constants} | {count.spoke} | {count.tried} | {count.flips} "
            f"| {count.per_thousand(answered):.1f} | {count.worse} | {count.better} |"
        )
