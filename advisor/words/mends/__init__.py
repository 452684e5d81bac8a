"""Remedies for a record that falls short, in the words of its autopilot's users.

A vehicle is heard over telemetry, live or from a ``.tlog``, or read from the log that its autopilot keeps.
Each of these has other names for the values, and other settings for their rates.
"""

from advisor.words.mends.choice import Carrier, mends_of
from advisor.words.mends.mends import GOOD_HZ, Mends, sentence

__all__ = ["GOOD_HZ", "Carrier", "Mends", "mends_of", "sentence"]
