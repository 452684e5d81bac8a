"""The effects that may be missing, each a few numbers in the simulator."""
