"""Residuals that no effect of the catalogue explains, and the blocks in which they arise."""
