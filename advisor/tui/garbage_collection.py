"""Garbage collection while nobody waits.

Python collects whenever enough objects were made, most often while a key is being answered. Every few
milliseconds it examines the newest objects. Now and then it examines all objects, which delays everything by
10 to 50 ms.
"""

import gc

_LOT = 5_000
"""Number of new objects that is worth a collection of one millisecond. Repainting a large screen makes five
times as many."""
_LOTS = 5
"""Number of collections after which their survivors are examined with all other objects."""


class Garbage:
    """Runs collections at times when nobody waits, in place of Python's own."""

    def begin(self) -> None:
        """Take over from Python. Objects imported so far stay alive and are never examined."""
        gc.freeze()
        gc.disable()

    def end(self) -> None:
        """Give control back to Python."""
        gc.enable()
        gc.unfreeze()

    def collect_if_due(self) -> None:
        """Collect garbage once enough new objects exist."""
        new, lots, _ = gc.get_count()
        if lots >= _LOTS:
            gc.collect()
        elif new >= _LOT:
            gc.collect(0)
