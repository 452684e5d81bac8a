"""What no effect of the catalogue explains, and in which block it is."""
