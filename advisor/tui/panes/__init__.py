"""Panes: one widget, one question of the crew."""
