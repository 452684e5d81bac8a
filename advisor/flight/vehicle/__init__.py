"""The vehicle: who sends, its modes, its parameters, and what its servo outputs move."""
