"""Studies that only people run: the names that they import exist."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

STUDIES = sorted(Path("benchmarks").rglob("*.py"))
HERE = ("advisor", "benchmarks", "sim")


def imported(study: Path) -> Iterator[tuple[str, str]]:
    """Yield module and name of each import of a name from this project."""
    for node in ast.walk(ast.parse(study.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and not node.level and str(node.module).split(".")[0] in HERE:
            yield from ((str(node.module), alias.name) for alias in node.names)


@cache
def names_of(module: str) -> frozenset[str]:
    """Return the names that a module or a package of this project has, its modules among them."""
    path = Path(*module.split("."))
    text = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    inside = {entry.stem for entry in path.iterdir()} if path.is_dir() else set()
    for node in ast.walk(ast.parse(text.read_text(encoding="utf-8"))) if text.is_file() else ():
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef):
            inside.add(node.name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            inside |= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            inside.add(node.id)
    return frozenset(inside)


@pytest.mark.parametrize("study", STUDIES, ids=str)
def test_every_name_that_a_study_imports_exists(study: Path) -> None:
    assert [f"{module}.{name}" for module, name in imported(study) if name not in names_of(module)] == []
