"""All effects by name: the thirty of the contract, and the kinds outside its catalogue."""

from .named_instruments import NAMED_IN_INSTRUMENTS
from .named_motion import NAMED_IN_MOTION
from .outside_instruments import OUTSIDE_IN_INSTRUMENTS
from .outside_motion import OUTSIDE_IN_MOTION

NAMED = (*NAMED_IN_MOTION, *NAMED_IN_INSTRUMENTS)
OUTSIDE = (*OUTSIDE_IN_MOTION, *OUTSIDE_IN_INSTRUMENTS)
EFFECTS = {effect.name: effect for effect in (*NAMED, *OUTSIDE)}
