"""Remedies for a record with missing or slow data. Each remedy uses the autopilot's own names.

The data of a vehicle come over telemetry, live or from a ``.tlog``, or from the autopilot's own log.
Each kind of sender has other names for the values, and other settings for their rates.
"""

from typing import Literal

from advisor.words.mends.dataflash import Dataflash
from advisor.words.mends.mends import GOOD_HZ, Mends, sentence
from advisor.words.mends.table import Table
from advisor.words.mends.telemetry import ArduPilotTelemetry, OtherTelemetry, Px4Telemetry
from advisor.words.mends.ulog import Ulog

__all__ = ["GOOD_HZ", "Carrier", "Mends", "mends_of", "sentence"]

Carrier = Literal["telemetry", "dataflash", "ulog", "table"]
"""Kind of record: a link or its ``.tlog``, ArduPilot's ``.bin``, PX4's ``.ulg``, or a table with named
columns."""


def mends_of(autopilot: str, carrier: Carrier, log_profile: int | None = None) -> Mends:
    """Return the remedies for a vehicle.

    Parameters
    ----------
    autopilot
        ``ardupilot``, ``px4``, or another name.
    log_profile
        Value of SDLOG_PROFILE in a PX4 log; None if unknown.
    """
    if carrier == "dataflash":
        return Dataflash()
    if carrier == "ulog":
        return Ulog(log_profile)
    if carrier == "table":
        return Table()
    telemetry: dict[str, Mends] = {"ardupilot": ArduPilotTelemetry(), "px4": Px4Telemetry()}
    return telemetry.get(autopilot, OtherTelemetry())
