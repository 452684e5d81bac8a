"""Wind along the aircraft's heading and to its right."""

import numpy as np

from advisor.flight.signals.record import Channel


def along_heading(north: Channel, east: Channel, heading: Channel) -> dict[str, Channel]:
    """Return the channels ``wind_along`` and ``wind_right`` at the stamps of the wind.

    Parameters
    ----------
    north, east
        Horizontal velocity of the air, m/s, from one message.
    heading
        Heading in rad, which may jump by 2π.
    """
    facing = np.interp(north.t, heading.t, np.unwrap(heading.y))
    cos, sin = np.cos(facing), np.sin(facing)
    to_east = np.interp(north.t, east.t, east.y)
    of = {"wind_along": cos * north.y + sin * to_east, "wind_right": cos * to_east - sin * north.y}
    return {name: Channel(name, north.t, y, north.source, north.provenance) for name, y in of.items()}
