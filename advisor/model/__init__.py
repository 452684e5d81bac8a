"""The short-period model and its exact solution."""
