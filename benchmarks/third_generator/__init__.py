"""A third generator of flights with a withheld cause: wing in strips, tail in lagging downwash."""
