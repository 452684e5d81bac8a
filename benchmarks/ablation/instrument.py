"""Rules of ``advisor.gap`` made to report: an import hook rewrites the modules that hold them.

A rule is a function that says yes or no, one that returns a finding or None, and one that returns what came
in unless it knows better. A limit is a comparison with a constant of the package. Likelihoods, simulators and
records are no rules.
"""

import ast
import importlib.machinery
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import wraps
from importlib.abc import MetaPathFinder
from inspect import signature
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import numpy as np

from benchmarks.ablation.forks import Forks

ROOM = Path(__file__).parents[2] / "advisor" / "gap"
_NO_RULES = ("simulator", "fitting", "records", "candidates", "foresight", "noise")
"""Folders of the likelihood, of the catalogue, and of what is said of effects that cannot be seen."""
_NO_FINDINGS = {"str", "float", "Any", "FloatArray", "HeldOut", "Problem", "Point", "Maneuver", "Aircraft"}
"""Types of what is measured or prepared: a function that hands one on decides nothing."""
_HEARD, _WITHOUT = "__heard__", "__without__"

forks: Forks | None = None
"""The forks of the case that is being answered."""


def heard(rule: str, said: Any, otherwise: Any) -> Any:
    """Pass a rule's answer through the forks of the case, if there is one."""
    return said if forks is None else forks.heard(rule, said, otherwise)


def rules_in(tree: ast.Module) -> Iterator[tuple[str, ast.FunctionDef, str]]:
    """Name, function and kind of every rule: ``bool``, ``None``, or the parameter that is handed back."""
    for node in tree.body:
        inside = node.body if isinstance(node, ast.ClassDef) else [node]
        owner = f"{node.name}." if isinstance(node, ast.ClassDef) else ""
        for function in inside:
            if isinstance(function, ast.FunctionDef) and (kind := _kind(function)):
                yield owner + function.name, function, kind


def _kind(function: ast.FunctionDef) -> str | None:
    said = "" if function.returns is None else ast.unparse(function.returns)
    if said == "bool":
        return "bool"
    if said.endswith("| None"):
        return "None"
    named = [(a.arg, a.annotation) for a in function.args.args if a.annotation is not None]
    same = [name for name, annotation in named if ast.unparse(annotation) == said]
    return same[0] if same and said not in _NO_FINDINGS else None


def module_files() -> list[Path]:
    """Every module that may hold rules."""
    return [p for p in sorted(ROOM.rglob("*.py")) if p.relative_to(ROOM).parts[0] not in _NO_RULES]


def is_constant(name: str) -> bool:
    """Whether a name is in capitals."""
    return name.lstrip("_").isupper() and len(name.lstrip("_")) > 1


class _Reporting(ast.NodeTransformer):
    """Functions that are rules get a decorator; comparisons with constants, a call."""

    def __init__(self, module: str, tree: ast.Module, limits: bool) -> None:
        self.module, self.limits, self.within = module, limits, ""
        self.rules = {id(f): (name, kind) for name, f, kind in rules_in(tree)}
        self.count: dict[str, int] = {}

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        outer, self.within = self.within, node.name
        name, kind = self.rules.get(id(node), ("", ""))
        self.generic_visit(node)
        self.within = outer
        if kind:
            rule = [ast.Constant(f"{self.module}:{name}"), ast.Constant(kind)]
            node.decorator_list.append(ast.Call(ast.Name(_WITHOUT, ast.Load()), rule, []))
        return node

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        used = [n.id for n in ast.walk(node) if isinstance(n, ast.Name) and is_constant(n.id)]
        self.generic_visit(node)
        if not (self.limits and used and self.within):
            return node
        name = f"{self.module}:{self.within} {' '.join(dict.fromkeys(used))}"
        self.count[name] = self.count.get(name, 0) + 1
        said = ast.Constant(name if self.count[name] == 1 else f"{name} {self.count[name]}")
        return ast.Call(ast.Name(_HEARD, ast.Load()), [said, node], [])


def _limit(rule: str, said: Any) -> Any:
    """A comparison as it came out, and where it was forced the other way."""
    if not isinstance(said, bool | np.bool_):
        return said
    return heard(f"{rule} = {not said}", said, not said)


def _without(rule: str, kind: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A decorator for a rule of some kind."""

    def reporting(function: Callable[..., Any]) -> Callable[..., Any]:
        handed = kind not in ("bool", "None")
        place = list(signature(function).parameters).index(kind) if handed else 0

        @wraps(function)
        def asked(*args: Any, **options: Any) -> Any:
            said = function(*args, **options)
            if kind == "bool":
                return heard(f"{rule} = {not said}", said, not said)
            otherwise = None if not handed else options[kind] if kind in options else args[place]
            return said if said is otherwise else heard(rule, said, otherwise)

        return asked

    return reporting


class _Loader(importlib.machinery.SourceFileLoader):
    limits = False

    def source_to_code(self, data: Any, path: Any, *, _optimize: int = -1) -> CodeType:
        tree = ast.parse(data, path)
        module = Path(path).relative_to(ROOM).with_suffix("").as_posix()
        tree = ast.fix_missing_locations(_Reporting(module, tree, self.limits).visit(tree))
        return compile(tree, path, "exec", dont_inherit=True)

    def get_code(self, fullname: str) -> CodeType:
        """Compile anew: cached code does not report."""
        path = self.get_filename(fullname)
        return self.source_to_code(self.get_data(path), path)

    def exec_module(self, module: ModuleType) -> None:
        module.__dict__.update({_HEARD: _limit, _WITHOUT: _without})
        super().exec_module(module)


class _Finder(MetaPathFinder):
    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> Any:
        spec = importlib.machinery.PathFinder.find_spec(fullname, path)
        if spec is not None and spec.origin is not None and Path(spec.origin) in set(module_files()):
            spec.loader = _Loader(fullname, spec.origin)
        return spec if fullname.startswith("advisor.gap.") else None


def install(limits: bool) -> None:
    """Let every module of ``advisor.gap`` that is imported from now on report its rules, or limits, too."""
    _Loader.limits = limits
    sys.meta_path.insert(0, _Finder())
