"""Every explanation of a flight as a full model with its marginal likelihood; their posterior is the answer."""
