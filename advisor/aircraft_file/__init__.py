"""Aircraft files: writing one for a user, and checking one for missing keys."""
