"""Panes of the screens. Each pane answers one question of the crew."""
