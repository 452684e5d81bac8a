"""The judge: from the evidence on every alternative to probabilities, and to the reasons in nats."""
