"""Output-error estimation: cost, optimiser, covariance, joint estimate."""
