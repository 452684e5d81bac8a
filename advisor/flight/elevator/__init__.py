"""The elevator: its servo outputs, their mixing, its sign, and a guess of its output."""
