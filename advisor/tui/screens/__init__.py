"""Screens: the pilot's, the engineer's, and the dialogs over them."""
