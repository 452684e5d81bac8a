"""Campaigns in blocks, so that a study is many tasks."""

from collections.abc import Iterator


def blocks(campaigns: int, size: int) -> Iterator[tuple[int, int]]:
    """Number and size of the blocks that campaigns are flown in.

    The size is a constant of the study, not a matter of the workers: a block has a seed of its own.
    """
    for number, first in enumerate(range(0, campaigns, size)):
        yield number, min(size, campaigns - first)
