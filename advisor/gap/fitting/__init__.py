"""The joint estimate over all manoeuvres: search, covariance, and what it is worth on those kept out."""
