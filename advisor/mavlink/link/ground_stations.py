"""Other ground stations on the link, and how each can leave the stream rates alone."""

from collections.abc import Collection

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.framing import Frame

CURE = (
    "start MAVProxy with --streamrate=-1, set Mission Planner's telemetry rates to -1, or let the vehicle "
    "control the stream rates in QGroundControl"
)


def is_ground_station(frame: Frame) -> bool:
    """Return whether a frame is the heartbeat of a ground station."""
    if frame.message_id != dialect.MAVLINK_MSG_ID_HEARTBEAT:
        return False
    payload = frame.payload.ljust(9, b"\0")
    return (payload[4], payload[5]) == (dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID)


def who_sets_rates(stations: Collection[int]) -> str:
    """Return a clause about the station that may have changed the rates, with the remedy."""
    if not stations:
        return f"another ground station may set the rates, though none is heard here; {CURE}"
    which = ", ".join(map(str, sorted(stations)))
    several = len(stations) > 1
    who = f"ground stations {which} are" if several else f"ground station {which} is"
    return f"{who} at work on this link and may set the rates; {CURE}"
