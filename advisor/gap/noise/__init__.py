"""The noise of a flight: coloured instruments, moving air, and jitter of the stamps."""
