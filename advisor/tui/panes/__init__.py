"""Panes: each widget answers one question of the crew."""
