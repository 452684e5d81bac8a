"""The sim-to-real gap: where it lies, which effect causes it, how far it shrinks."""
