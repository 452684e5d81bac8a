"""Looking for garbage while nobody waits.

A full collection visits every object there is and holds everything up for 10 to 50 ms. Python begins one
whenever enough objects have outlived the collections of the young: most often amid what a key has set off.
"""

import gc

_NEVER = 1_000_000
_OVERDUE = 20
"""Times Python's own threshold, at which a collection waits no longer."""


class Garbage:
    """Full collections when told that nobody waits; those of the young take a millisecond and go on."""

    def __init__(self) -> None:
        self._usual = gc.get_threshold()

    def begin(self) -> None:
        """Take over. What was imported so far lives as long as the application and is not looked at again."""
        gc.freeze()
        gc.set_threshold(*self._usual[:2], _NEVER)

    def end(self) -> None:
        """Give back."""
        gc.set_threshold(*self._usual)
        gc.unfreeze()

    def collect_if_due(self, quiet: bool) -> None:
        """Collect if Python would have by now; while keys come in, only if it would have long ago."""
        waiting, enough = gc.get_count()[2], self._usual[2]
        if waiting > enough * (1 if quiet else _OVERDUE):
            gc.collect()
