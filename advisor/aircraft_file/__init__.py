"""Aircraft files: how a new one is written, and how one is checked for missing keys."""
