"""What we believe: the short-period model and its exact solution."""
