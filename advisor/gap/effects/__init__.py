"""The effects that a diagnosis can name: one module for each, which makes its ``EFFECT``.

A new module is found by itself.
"""

from collections.abc import Iterator
from importlib import import_module
from pkgutil import iter_modules

from advisor.gap.kit.effect import BLOCKS, Effect


def _found() -> Iterator[Effect]:
    for module in iter_modules(__path__, f"{__name__}."):
        yield import_module(module.name).EFFECT


EFFECTS: dict[str, Effect] = {
    effect.name: effect for effect in sorted(_found(), key=lambda e: (BLOCKS.index(e.block), e.name))
}
"""Every effect by its name, in the order of the blocks and then of the alphabet."""
