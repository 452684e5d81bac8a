"""The judge of the gap diagnosis: flights with known causes, the fit of its weights, and its scores."""
