"""Writing of a new aircraft file, and check of an aircraft file for missing keys."""
