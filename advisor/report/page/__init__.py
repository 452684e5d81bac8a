"""The page of a flight: one self-contained document for people who were not there."""
