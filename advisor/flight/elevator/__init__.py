"""The elevator: its outputs, their mixing, sign and guess."""
