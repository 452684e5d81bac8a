"""Fly over a MAVLink link, in real time or faster."""

import os
import time
from collections.abc import Callable
from contextlib import suppress

# pymavlink chooses protocol and dialect from the environment at import.
os.environ.setdefault("MAVLINK20", "1")
os.environ.setdefault("MAVLINK_DIALECT", "ardupilotmega")

from pymavlink import mavutil

from .flight import Flight
from .mavlink import COMPONENT, SYSTEM
from .telemetry import Telemetry


def serve(
    flight: Flight,
    connection: str,
    speed: float | None = 1.0,
    tell: Callable[[str], None] = lambda text: None,
) -> int:
    """Fly the whole scenario over ``connection`` and return the number of messages sent.

    Parameters
    ----------
    flight
        Flight to fly.
    connection
        Connection string of pymavlink, e.g. ``udpout:127.0.0.1:14550``.
    speed
        Speed of the flight as a multiple of real time. None for the highest possible speed.
    tell
        Function that is called with a sentence at the begin of each manoeuvre.

    Notes
    -----
    Requests are heard while flying: parameters, message intervals, stream rates.
    """
    link = mavutil.mavlink_connection(connection, source_system=SYSTEM, source_component=COMPONENT)
    try:
        return _fly(link, flight, speed, tell)
    finally:
        link.close()


def _fly(link: mavutil.mavfile, flight: Flight, speed: float | None, tell: Callable[[str], None]) -> int:
    telemetry = Telemetry(flight)
    upcoming = list(flight.planned)
    began = time.monotonic()
    sent = 0
    for burst in telemetry.bursts():
        if speed is not None:
            wait = began + burst.arrival_s / speed - time.monotonic()
            if wait > 0:
                time.sleep(wait)
        if upcoming and burst.time_s >= upcoming[0].start_s:
            planned = upcoming.pop(0)
            tell(f"{planned.start_s:7.1f} s  {planned.maneuver.input}")
        # Nobody may be listening yet, or any more; the aircraft flies on.
        with suppress(ConnectionError):
            for message in burst.messages:
                link.mav.send(message)
                sent += 1
            sent += _answer(link, telemetry)
    return sent


def _answer(link: mavutil.mavfile, telemetry: Telemetry) -> int:
    replies = 0
    while (message := link.recv_msg()) is not None:
        for reply in telemetry.voice.hear(message):
            link.mav.send(reply)
            replies += 1
    return replies
