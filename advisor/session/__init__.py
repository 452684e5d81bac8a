"""A live or replayed flight without a screen: its source, its conductor, and its state for any display."""
