"""Effects that a flight could not show."""
