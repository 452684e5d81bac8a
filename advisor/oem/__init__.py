"""Output error: cost, optimiser, covariance, joint estimate."""
