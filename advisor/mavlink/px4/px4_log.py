"""A PX4 log as the messages that its telemetry would have carried."""

from typing import Any

import numpy as np

from advisor.mavlink.px4 import px4_vehicle
from advisor.mavlink.px4.px4_air import air
from advisor.mavlink.px4.px4_motion import motion
from advisor.mavlink.px4.px4_outputs import outputs
from advisor.mavlink.px4.px4_topics import TimedMessages, Topics


def translate(log: Any, topics: Topics) -> list[TimedMessages]:
    """Return every message from a `pyulog.ULog` and its topics."""
    parameters = px4_vehicle.parameters_of(log)
    breathed, said = air(topics)
    moved = outputs(topics, parameters)
    messages = [
        *motion(topics, bool(parameters.get("SENS_BOARD_ROT"))),
        *breathed,
        *px4_vehicle.named_values(topics),
        *px4_vehicle.receiver(topics),
        *moved.messages,
        *px4_vehicle.texts(log),
    ]
    start_us = min((int(np.min(m.time_us)) for m in messages), default=0)
    return [
        px4_vehicle.heartbeat(topics, parameters, start_us),
        *px4_vehicle.vtol_states(topics),
        *px4_vehicle.version(log, start_us),
        *px4_vehicle.stated(log, moved.found, start_us),
        *px4_vehicle.remarks([*said, *moved.said, *px4_vehicle.dropouts(log)], start_us),
        *messages,
    ]
