"""What the crew can do about a record that falls short, in the words that its autopilot's users know.

A vehicle is heard over telemetry, live or from a ``.tlog``, or read from the log that its autopilot keeps.
Each of these calls the same values by other names and has other settings for their rates.
"""

from advisor.mends.choice import Carrier, mends_of
from advisor.mends.mends import GOOD_HZ, Mends, sentence

__all__ = ["GOOD_HZ", "Carrier", "Mends", "mends_of", "sentence"]
