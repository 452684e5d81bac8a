"""The joint estimate over all manoeuvres: search, covariance, and hold-out."""
