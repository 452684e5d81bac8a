"""The improvement that a diagnosis found, in the formats of other simulators."""
