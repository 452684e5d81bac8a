"""The catalogue: every named effect as low-order terms, one file a block of the simulator."""
