"""The estimator's problems by axis."""
