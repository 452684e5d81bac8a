"""A test that takes its limit from the code agrees with any limit: no test imports a number that decides.

Every number counts that a module of the advisor binds to a name in capitals. Tables, places in an array and
the modules of ``ALLOWED`` do not count, because nothing is compared with them. The limit stands in the test
as a number, or follows from physics.
"""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ALLOWED = {
    "advisor.aircraft.standard_gravity": "a constant of nature",
    "advisor.gap.simulator.pack": "width of an array",
    "advisor.model.outputs": "width of an array",
    "advisor.model.transition": "width of an array",
    "advisor.oem.gauss_newton": "names of the ends of a search",
    "advisor.tui.plot.painting": "a character",
}
"""Modules whose numbers are no limits, and what they are."""
UNCHECKED = tuple(
    f"advisor.gap.{room}."
    for room in ("fitting", "foresight", "inference", "search", "uncatalogued", "verdict")
)
"""Rooms of the gap diagnosis whose limits only whole diagnoses show."""


def test_no_number_that_decides_comes_from_the_code() -> None:
    taken = {
        f"{path.relative_to(ROOT)} imports {name} of {module}"
        for path in (ROOT / "tests").rglob("*.py")
        for module, name in taken_from_the_code(ast.parse(path.read_text(encoding="utf-8")))
    }
    assert not taken, "write the limit into the test as a number, with a word about its reason"


@pytest.mark.parametrize(
    "text",
    [
        "from advisor.doctor.limits import LOSSY_PERCENT",
        "from advisor.doctor.limits import LOSSY_PERCENT as limit",
        "from advisor.doctor import limits\nprint(limits.LOSSY_PERCENT)",
        "def test():\n    import advisor.doctor.limits as there\n    print(there.LOSSY_PERCENT)",
    ],
)
def test_a_limit_is_seen_however_it_is_taken(text: str) -> None:
    assert list(taken_from_the_code(ast.parse(text))) == [("advisor.doctor.limits", "LOSSY_PERCENT")]


@pytest.mark.parametrize(
    "text",
    [
        "from advisor.doctor.limits import loss_limits",
        "from advisor.aircraft.standard_gravity import GRAVITY_M_S2",
        "from advisor.decision.first_unit import ORDERS",
        "from sim.airframe import GRAVITY_M_S2",
    ],
)
def test_functions_tables_and_constants_of_nature_are_no_limits(text: str) -> None:
    assert not list(taken_from_the_code(ast.parse(text)))


@pytest.mark.parametrize("module", ALLOWED)
def test_every_module_of_the_list_has_numbers(module: str) -> None:
    assert numbers_of(module)


def taken_from_the_code(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Yield module and name of every number that a test takes from a module of the advisor."""
    modules: dict[str, str] = {}
    read: list[tuple[str, str]] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            if node.attr.isupper() and isinstance(node.value, ast.Name):
                read.append((node.value.id, node.attr))
        elif isinstance(node, ast.Import):
            modules.update({one.asname: one.name for one in node.names if one.asname})
        elif isinstance(node, ast.ImportFrom) and node.module:
            modules.update({one.asname or one.name: f"{node.module}.{one.name}" for one in node.names})
            yield from ((node.module, one.name) for one in node.names if decides(node.module, one.name))
    yield from ((modules[known], name) for known, name in read if decides(modules.get(known, ""), name))


def decides(module: str, name: str) -> bool:
    """Return whether a name of a module is a number that may decide."""
    is_checked = module not in ALLOWED and not module.startswith(UNCHECKED)
    return is_checked and module.startswith("advisor.") and name in numbers_of(module)


@cache
def numbers_of(module: str) -> frozenset[str]:
    """Return the names in capitals that a module binds to a number."""
    path = ROOT.joinpath(*module.split(".")).with_suffix(".py")
    if not path.exists():
        return frozenset()
    return frozenset(
        name
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None
        for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
        for name, value in bound(target, node.value)
        if name.isupper() and is_number(value)
    )


def bound(target: ast.expr, value: ast.expr) -> Iterator[tuple[str, ast.expr]]:
    """Yield every name of an assignment with its value."""
    if isinstance(target, ast.Name):
        yield target.id, value
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for one, own in zip(target.elts, value.elts, strict=True):
            yield from bound(one, own)


def is_number(value: ast.expr) -> bool:
    """Return whether an expression is arithmetic of numbers, functions of numbers among it."""
    match value:
        case ast.Constant():
            return type(value.value) in (int, float)
        case ast.UnaryOp():
            return is_number(value.operand)
        case ast.BinOp():
            return is_number(value.left) or is_number(value.right)
        case ast.Call():
            return bool(value.args) and all(map(is_number, value.args))
    return False
