"""Campaigns in blocks, so that a study is many tasks."""

from collections.abc import Iterator


def blocks(campaigns: int, size: int) -> Iterator[tuple[int, int]]:
    """Yield the number and the size of each block of campaigns.

    The size is a constant of the study and independent of the workers, because a block has a seed of its own.
    """
    for number, first in enumerate(range(0, campaigns, size)):
        yield number, min(size, campaigns - first)
