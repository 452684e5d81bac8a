"""Garbage collection at times without a pending key.

Python collects garbage whenever enough objects were made, most often while a key is being answered. Every few
milliseconds Python examines the newest objects. Now and then Python examines all objects, which takes 10 to
50 ms.
"""

import gc

_LOT = 5_000
"""Number of new objects after which garbage is collected; a collection takes one millisecond. Painting a
large screen makes five times as many objects.
"""
_LOTS = 5
"""Number of collections of new objects after which all objects are examined."""


class Garbage:
    """Runs garbage collections at times without a pending key, instead of Python's own."""

    def begin(self) -> None:
        """Stop Python's own garbage collection. Objects that exist already are never examined."""
        gc.freeze()
        gc.disable()

    def end(self) -> None:
        """Start Python's own garbage collection again."""
        gc.enable()
        gc.unfreeze()

    def collect_if_due(self) -> None:
        """Collect garbage once enough new objects exist."""
        new, lots, _ = gc.get_count()
        if lots >= _LOTS:
            gc.collect()
        elif new >= _LOT:
            gc.collect(0)
