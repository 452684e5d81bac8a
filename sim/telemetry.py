"""Telemetry of a flight: messages in order, with the effects of the radio link."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .faulty import Outgoing, again, stated
from .flight import Flight
from .mavlink import Message, Voice

GREETING = "Bundled aircraft, ArduPlane V4.5.6 manners"
"""Text that the vehicle repeats, which identifies a simulated aircraft."""

GREETING_EVERY_S = 10.0


@dataclass(frozen=True)
class Burst:
    """Messages of one tick of the loop."""

    time_s: float
    """Simulated time, seconds since the log began."""
    arrival_s: float
    """Time of arrival at the receiver, s."""
    messages: list[Message]


class Telemetry:
    """Flight of a scenario with the messages that its vehicle sends."""

    def __init__(self, flight: Flight) -> None:
        self.flight = flight
        scenario = flight.scenario
        # A held command jumps within one step of the integration; on average in its middle.
        late = 0.5 * scenario.step_s if scenario.input == "held" else 0.0
        self.voice = Voice(dict(scenario.rates), scenario.clock, flight.calibration, late)
        self.voice.parameters |= stated(scenario.faults.filters)
        self._outgoing = Outgoing(scenario.faults)
        self._generator = np.random.default_rng([scenario.seed, 9])

    def bursts(self) -> Iterator[Burst]:
        """Yield the messages of the vehicle, tick by tick."""
        scenario = self.flight.scenario
        parameters_s, repeated_s = scenario.faults.parameters_at_s, scenario.faults.repeated_after_s
        arrival, greeting_s, was_flying = 0.0, 0.0, False
        for sample in self.flight.samples():
            if sample.time_s >= parameters_s:
                # A ground station on the same link has asked for the parameters.
                self.voice.send_parameters()
                parameters_s = math.inf
            if scenario.said and (sample.flying is not None) != was_flying:
                self.voice.say(scenario.said[was_flying])
                was_flying = not was_flying
            if sample.time_s >= greeting_s:
                self.voice.say(GREETING)
                greeting_s += GREETING_EVERY_S
            error = scenario.clock.jitter_s
            stamp_error = float(self._generator.uniform(-error, error)) if error > 0 else 0.0
            messages = list(self._outgoing.changed(self.voice.speak(sample, stamp_error)))
            flying = sample.flying
            if flying and 0.0 <= sample.time_s - flying.start_s < flying.maneuver.outage_s:
                continue
            if scenario.link.drop > 0.0:
                kept = self._generator.random(len(messages)) >= scenario.link.drop
                messages = [message for message, keep in zip(messages, kept, strict=True) if keep]
            late = float(self._generator.exponential(0.3)) if scenario.link.jitter_s > 0.0 else 0.0
            arrival = max(arrival, sample.time_s + scenario.link.jitter_s * min(late, 1.0))
            yield Burst(sample.time_s, arrival, messages)
            if repeated_s > 0.0:
                arrival += repeated_s
                repeated = [again(message, repeated_s) for message in messages]
                yield Burst(sample.time_s + repeated_s, arrival, repeated)
