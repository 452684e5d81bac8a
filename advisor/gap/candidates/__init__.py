"""The candidate effects, each described by a few parameters of the simulation."""
