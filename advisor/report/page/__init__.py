"""Page of a flight: one self-contained document for readers who were not there."""
