"""Pages of the gap diagnosis that are made from the code, from scored runs and from a shipped log."""
