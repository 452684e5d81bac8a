"""Aircraft files: written for a user, and looked over for keys that they lack."""
