"""The tests nearest to a module: its mirror, then those with the shortest chain of imports to the module."""

import ast
from collections.abc import Iterator
from importlib.util import resolve_name
from pathlib import Path

MOST_FILES = 8
"""Most files of tests that are run on one mutant."""
FARTHEST = 3
"""Longest chain of imports from a test to the changed module."""


class Imports:
    """Who imports whom in ``advisor``, ``sim`` and ``tests``."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._files = {
            ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path
            for part in ("advisor", "sim", "tests")
            for path in sorted((root / part).rglob("*.py"))
        }
        self._importers: dict[str, set[str]] = {}
        for name, path in self._files.items():
            for imported in self._imports_of(name, path):
                self._importers.setdefault(imported, set()).add(name)

    def nearest(self, file: str) -> list[str]:
        """Return the files of the nearest tests, the nearest first.

        Parameters
        ----------
        file
            Changed file under the root of the tree, such as ``advisor/oem/prior.py``.
        """
        changed = Path(file).with_suffix("").parts[1:]
        room = Path("tests", *changed[:-1])
        ranks = []
        for name, chain in self._chains(".".join(("advisor", *changed)).removesuffix(".__init__")).items():
            path = self._files[name].relative_to(self._root)
            if path.name.startswith("test_"):
                is_mirror = path == room / f"test_{changed[-1]}.py"
                size = self._files[name].stat().st_size
                ranks.append((not is_mirror, chain + (path.parent != room), size, path.as_posix()))
        return [path for *_, path in sorted(ranks)[:MOST_FILES]]

    def _chains(self, module: str) -> dict[str, int]:
        """Return the length of the shortest chain of imports from every module that imports ``module``."""
        found, ahead = {module: 0}, [module]
        for name in ahead:
            if found[name] < FARTHEST:
                for importer in sorted(self._importers.get(name, ())):
                    if importer not in found:
                        found[importer] = found[name] + 1
                        ahead.append(importer)
        return found

    def _imports_of(self, name: str, path: Path) -> Iterator[str]:
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match node:
                case ast.Import():
                    yield from (one.name for one in node.names if one.name in self._files)
                case ast.ImportFrom():
                    origin = resolve_name("." * node.level + (node.module or ""), package)
                    inside = {f"{origin}.{one.name}" for one in node.names} & self._files.keys()
                    yield from inside or {origin} & self._files.keys()
