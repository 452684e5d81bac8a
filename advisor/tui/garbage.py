"""Looking for garbage while nobody waits.

Python looks whenever enough objects were made, which is most often amid what a key has set off: every few
milliseconds at those just made, and now and then at all there are, which holds everything up for 10 to 50 ms.
"""

import gc

_LOT = 5_000
"""New objects worth a look, of a millisecond; repainting a large screen makes five times as many."""
_LOTS = 5
"""After so many, what was left of them is looked at with all the rest."""


class Garbage:
    """Collections when told that nobody waits, instead of Python's own."""

    def begin(self) -> None:
        """Take over. What was imported so far lives as long as the application and is not looked at again."""
        gc.freeze()
        gc.disable()

    def end(self) -> None:
        """Give back."""
        gc.enable()
        gc.unfreeze()

    def collect_if_due(self) -> None:
        """Collect if there is enough to look at."""
        new, lots, _ = gc.get_count()
        if lots >= _LOTS:
            gc.collect()
        elif new >= _LOT:
            gc.collect(0)
