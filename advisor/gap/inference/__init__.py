"""Every explanation of a flight as a full model with its evidence; their posterior is the answer."""
