"""A flight as a test: the expectations of a crew, the results of a log, and the outcomes."""
