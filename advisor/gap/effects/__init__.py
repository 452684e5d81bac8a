"""Effects that a diagnosis can name, with one module for each effect.

A new module in this folder is added to the catalogue automatically.
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
