"""Inference: every explanation of a flight is a full model with its evidence, and the posterior of all models
is the answer.
"""
