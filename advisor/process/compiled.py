"""Compiled functions on disk, compiled again after any change of their source text.

Numba freezes into a kernel's machine code the functions that the kernel calls and the constants that it
reads. Numba's own cache depends only on the text of the kernel's file, so that stale machine code would
survive a change elsewhere. The key here is the text of the kernel's file and of every module of the package
that it imports, directly or through others. A contract of imports (``pyproject.toml``) keeps the number of
these modules small.
"""

import ast
import hashlib
import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from typing import Any, TypeVar, cast

# numba takes settings from a file .numba_config.yaml of the current folder, among them the folder from which
# machine code is loaded. Without PyYAML in sight numba leaves that file alone, now and at every compilation.
_yaml = sys.modules.get("yaml")
sys.modules["yaml"] = None  # type: ignore[assignment]
try:
    import numba
    from numba.core import caching
finally:
    if _yaml is None:
        del sys.modules["yaml"]
    else:
        sys.modules["yaml"] = _yaml

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(**options: Any) -> Callable[[Function], Function]:
    """Compile a function at its first call, and keep the machine code on disk if a folder allows this.

    Numba keeps machine code in ``NUMBA_CACHE_DIR``, next to the module, or in the user's own cache:
    the first that can be written to. Without such a folder each process compiles for itself.

    Returns
    -------
    The decorator of the function, whose own annotations stay.
    """

    def compiled(function: Function) -> Function:
        dispatcher: Any = numba.njit(**options)(function)
        if dispatcher is not function:  # NUMBA_DISABLE_JIT leaves functions as they are.
            with suppress(RuntimeError):  # numba finds no folder to write to
                dispatcher.enable_caching()
                dispatcher._cache._cache_file.__class__ = _Kept
                dispatcher._cache._cache_file._source_stamp = key_of(function.__module__)
        return cast("Function", dispatcher)

    return compiled


_CacheFile: Any = caching.IndexDataCacheFile


class _Kept(_CacheFile):  # type: ignore[misc]
    """Machine code on disk. A full disk keeps no code, and a truncated file counts as missing."""

    def save(self, key: Any, data: Any) -> None:
        """Save the code before the index that marks the code as current.

        Numba writes the index first. A disk that fills in between would leave old code under a new index.
        """
        kept = self._load_index()
        free = (self._data_name(n) for n in range(1, len(kept) + 2))
        name = kept.get(key) or next(candidate for candidate in free if candidate not in kept.values())
        with suppress(OSError):
            self._save_data(name, data)
            self._save_index(kept | {key: name})

    def _load_index(self) -> Any:
        try:
            return super()._load_index()
        except (pickle.UnpicklingError, EOFError):
            return {}

    def _load_data(self, name: str) -> Any:
        try:
            return super()._load_data(name)
        except (pickle.UnpicklingError, EOFError):
            return None


@cache
def key_of(module: str) -> str:
    """Return the hash of the texts of an imported module and of all modules of its package that it imports.

    ``module``: name of a module that is being imported, directly or by another module's imports.

    Returns
    -------
    SHA-256 in hexadecimal; equal wherever the texts are, whatever their folder and their time.
    """
    modules, ahead = set[str](), [module]
    while ahead:
        name = ahead.pop()
        if name not in modules:
            modules.add(name)
            ahead += _imports_of(name)
    whole = hashlib.sha256()
    for name in sorted(modules):
        whole.update(name.encode() + b"\0" + _text_of(name) + b"\0")
    return whole.hexdigest()


@cache
def _imports_of(module: str) -> tuple[str, ...]:
    """Return the package's modules that the top level of a module's text imports."""
    named = []
    for node in ast.parse(_text_of(module)).body:
        if isinstance(node, ast.Import):
            named += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            origin = resolve_name("." * node.level + (node.module or ""), sys.modules[module].__package__)
            named += [origin, *(f"{origin}.{alias.name}" for alias in node.names)]
    package = module.partition(".")[0]
    return tuple(name for name in named if name.partition(".")[0] == package and name in sys.modules)


@cache
def _text_of(module: str) -> bytes:
    file = sys.modules[module].__file__
    return b"" if file is None else Path(file).read_bytes()
