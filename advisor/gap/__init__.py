"""The sim-to-real gap: the block in which it lies, the effect that causes it, and how far it shrinks."""
