"""The proof of an improved simulator, and the models of other programs, for each axis."""
