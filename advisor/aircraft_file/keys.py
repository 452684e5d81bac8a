"""The keys of an aircraft file that a crew fills in, in the order of the file."""

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.key import keys_of

KEYS = tuple(key for key in keys_of(Aircraft) if key.example)
"""Keys that stand in a new file."""
