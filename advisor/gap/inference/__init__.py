"""Inference: every explanation of a flight is a full model with its evidence, and their posterior is the
answer."""
