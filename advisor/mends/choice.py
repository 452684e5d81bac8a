"""Which mends belong to an autopilot and a kind of record."""

from typing import Literal

from advisor.mends.dataflash import Dataflash
from advisor.mends.mends import Mends
from advisor.mends.telemetry import ArduPilotTelemetry, OtherTelemetry, Px4Telemetry
from advisor.mends.ulog import Ulog

Carrier = Literal["telemetry", "dataflash", "ulog"]
"""Messages of a link or a ``.tlog``, ArduPilot's own log (``.bin``), PX4's own log (``.ulg``)."""


def mends_of(autopilot: str, carrier: Carrier) -> Mends:
    """The mends for a vehicle.

    Parameters
    ----------
    autopilot
        ``ardupilot``, ``px4``, or another name.
    carrier
        What brings the vehicle's messages.
    """
    if carrier == "dataflash":
        return Dataflash()
    if carrier == "ulog":
        return Ulog()
    telemetry: dict[str, Mends] = {"ardupilot": ArduPilotTelemetry(), "px4": Px4Telemetry()}
    return telemetry.get(autopilot, OtherTelemetry())
