"""The improvement from a diagnosis, in the formats of other simulators."""
