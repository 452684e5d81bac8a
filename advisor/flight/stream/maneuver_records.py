"""Records of manoeuvres: channels that are cut from the tracks, repaired and examined."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from advisor.flight.instruments.axes.side_instruments import examine_side
from advisor.flight.instruments.examination import examine
from advisor.flight.instruments.examined import ExaminedRecords
from advisor.flight.instruments.measured import Evidence
from advisor.flight.maneuvers.maneuver import BEFORE_S, CONTROLS, Maneuver, Span
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S, along_heading
from advisor.flight.signals.record import AIR_UNITS, UNITS, Channel, counted_once, robust_std
from advisor.flight.signals.tracks import Tracks
from advisor.flight.signals.trust import Distrust, distrusted
from advisor.flight.stream.identity import Identity
from advisor.flight.vehicle.pieces import Breaks
from advisor.process.arrays import FloatArray
from advisor.words.quantities import clock

_WATCHED = {
    "q": "pitch rate",
    "p": "roll rate",
    "r": "yaw rate",
    "theta": "pitch angle",
    "bank": "bank angle",
    "a_x": "axial acceleration",
    "a_z": "normal acceleration",
    "alpha": "angle of attack",
    "airspeed": "air speed",
    "climb_rate": "climb rate",
}
"""Channels of continuous motion, with their names for people."""
_NOISE = 10.0
"""Least deviation of an outlier from its neighbours, in standard deviations of all such deviations."""
_OTHERS = (2.0, 98.0)
"""Percentiles that bound the range of the other samples."""
_MOST = 0.02
"""Largest share of outliers that counts as a fault of single samples, not of the channel. With more outliers,
the percentiles in ``_OTHERS`` would include them."""
_FEWEST = 20
"""Least number of samples from which a range is determined."""


@dataclass(frozen=True, slots=True)
class Repaired:
    """A channel after its repair."""

    channel: Channel
    said: tuple[str, ...] = ()
    """Sentences about the repair; empty for an unchanged channel."""


def repaired(channel: Channel) -> Repaired:
    """Return a manoeuvre's channel with samples removed or corrected that no aircraft can have flown."""
    if channel.name not in _WATCHED or len(channel) < _FEWEST:
        return Repaired(channel)
    mended, said = channel, []
    if channel.name == "alpha" and np.any(channel.y > pi):
        mended = replace(channel, y=np.where(channel.y > pi, channel.y - 2.0 * pi, channel.y))
        said.append(
            "The angle of attack is sent from 0 to 360 deg: values above 180 deg are read as negative."
        )
    if channel.name == "airspeed" and (dead := _dropped_out(mended)).any():
        at = f"{clock(float(mended.t[dead][0]))} to {clock(float(mended.t[dead][-1]))}"
        said.append(f"The air speed drops out from {at} and is bridged.")
        mended = replace(mended, t=mended.t[~dead], y=mended.y[~dead])
    wild = _wild(mended.y)
    n = int(np.count_nonzero(wild))
    if 0 < n <= _MOST * len(wild):
        mended = replace(mended, t=mended.t[~wild], y=mended.y[~wild])
        are = "samples are" if n > 1 else "sample is"
        said.append(f"{n} of {len(wild)} {_WATCHED[channel.name]} {are} wild and left out.")
    return Repaired(mended, tuple(said))


def _dropped_out(airspeed: Channel) -> NDArray[np.bool_]:
    """Return whether each air speed is below any flight speed, in a manoeuvre in flight."""
    dead = airspeed.y <= SLOWEST_FLIGHT_M_S
    # The aircraft loses half of its speed at most, so that it would not have stopped in the air.
    flies = float(np.median(airspeed.y)) > 2.0 * SLOWEST_FLIGHT_M_S
    return np.asarray(dead & flies)


def _wild(y: FloatArray) -> NDArray[np.bool_]:
    """Return whether each sample deviates from its neighbours by more than the others' range."""
    neighbours = 0.5 * (y[:-2] + y[2:])
    away = np.abs(y[1:-1] - neighbours)
    # A neighbour of a wild sample leaves the mean of its own neighbours by half as much.
    nearer = np.minimum(np.abs(y[1:-1] - y[:-2]), np.abs(y[1:-1] - y[2:]))
    low, high = np.percentile(y, _OTHERS)
    wild = np.zeros(len(y), dtype=bool)
    if not np.any(nearer > high - low):
        return wild
    wild[1:-1] = (nearer > high - low) & (away > _NOISE * robust_std(y[1:-1] - neighbours)) & (high > low)
    return wild


class ManeuverRecords:
    """Cutter of the records of one vehicle's manoeuvres."""

    def __init__(self, tracks: Tracks, who: Identity, breaks: Breaks) -> None:
        self.tracks, self._who, self._breaks = tracks, who, breaks
        self._modes = [(-np.inf, who.mode)]
        self._released = (0, -np.inf)
        self.pitch, self.sideways = ExaminedRecords(examine), ExaminedRecords(examine_side)
        """Manoeuvres of the elevator, and those of aileron and rudder."""

    def begin(self, mode: str) -> None:
        """Forget all manoeuvres, and begin a power-on in a flight mode."""
        self._modes = [(-np.inf, mode)]
        self.pitch.begin()
        self.sideways.begin()

    def change(self, mode: str, since_s: float) -> None:
        """Begin another flight mode."""
        self._modes.append((since_s, mode))

    def release(self, maneuver: Maneuver) -> None:
        """Keep the lead-in of later records out of the record of a manoeuvre of the elevator."""
        self._released = (maneuver.boot, maneuver.span.end_s)

    def stay(self, at_s: float) -> tuple[float, str]:
        """Return the start of the vehicle's stay in its flight mode at this time, and the mode."""
        return next(stay for stay in reversed(self._modes) if stay[0] <= at_s)

    def leaves_s(self, after_s: float) -> float:
        """Return the first time after ``after_s`` at which the flight mode may have changed, s since boot."""
        return max(min((since_s for since_s, _ in self._modes if since_s > after_s), default=np.inf), after_s)

    def of_pitch(
        self, span: Span, boot: int, up_to_order: int | None, grows: bool = False
    ) -> tuple[Maneuver, Evidence]:
        """Return the manoeuvre, with its evidence about the instruments.

        The instruments of a record that ``grows`` are examined now and then, not at every sample.
        """
        earlier_boot, earlier_s = self._released
        if earlier_boot == boot and earlier_s > span.record_from_s:
            # The lead-in does not reach into the record of another manoeuvre.
            span = replace(span, record_from_s=min(earlier_s, span.start_s))
        channels, notes = self._recorded(span, up_to_order)
        distrusts = self._who.distrusts(distrusted(channels))
        trusted = _trusted(channels, distrusts)
        maneuver, evidence = self._examined(self.pitch, span, boot, up_to_order, trusted, notes, grows)
        maneuver = replace(
            maneuver,
            distrusts=tuple(distrusts),
            missed_s=self._breaks.missed_s(span.record_from_s, span.end_s),
            leapt_s=self._breaks.leapt_s(span.record_from_s, span.end_s),
            scale=counted.scale if (counted := self._who.outputs.counted.get("elevator")) else None,
        )
        return maneuver, evidence

    def of_sides(self, span: Span, boot: int, up_to_order: int | None) -> tuple[Maneuver, Evidence]:
        """Return the record of a lateral manoeuvre, with its evidence about the instruments."""
        return self._examined(self.sideways, span, boot, up_to_order, *self._recorded(span, up_to_order))

    def _examined(
        self,
        axis: ExaminedRecords,
        span: Span,
        boot: int,
        up_to_order: int | None,
        channels: Mapping[str, Channel],
        notes: Sequence[str],
        grows: bool = False,
    ) -> tuple[Maneuver, Evidence]:
        length = (span.record_from_s, span.end_s)
        examined = axis.so_far(channels, *length) if grows else axis.examined(channels)
        recorded = {**examined.channels, **self._air(span, up_to_order)}
        mode = self.stay(_middle_s(span))[1]
        maneuver = Maneuver(
            axis.counted + 1, boot, span, recorded, mode, findings=examined.findings, data_notes=tuple(notes),
            before=self._before(recorded, span.record_from_s, up_to_order),
        )  # fmt: skip
        return maneuver, examined.evidence

    def _recorded(self, span: Span, up_to_order: int | None) -> tuple[dict[str, Channel], list[str]]:
        """Return the repaired channels of a record, and sentences about the repairs."""
        channels: dict[str, Channel] = {}
        notes = self._airspeed_notes(span, up_to_order)
        for name in UNITS:
            channel = self._whole(name, span, up_to_order)
            if channel is not None:
                sound = repaired(counted_once(self._who.identified(channel)))
                channels[name] = sound.channel
                notes += sound.said
        return channels, notes

    def _before(
        self, recorded: Mapping[str, Channel], record_from_s: float, up_to_order: int | None
    ) -> dict[str, Channel]:
        """Return the commands before a record, from the same sources as in the record."""
        commands = {}
        for name in recorded.keys() & set(CONTROLS):
            until_s = np.nextafter(recorded[name].t[0], -np.inf)
            before = self.tracks.cut(name, record_from_s - BEFORE_S, until_s, up_to_order)
            if before is not None and before.source == recorded[name].source:
                commands[name] = repaired(counted_once(before)).channel
        return commands

    def _air(self, span: Span, up_to_order: int | None) -> dict[str, Channel]:
        cut = {name: self._whole(name, span, up_to_order) for name in AIR_UNITS}
        air_channels = {name: air for name, air in cut.items() if air is not None}
        north, east, heading = (
            self._whole(name, span, up_to_order) for name in ("wind_north", "wind_east", "heading")
        )
        if north is None or east is None or heading is None:
            return air_channels
        return air_channels | along_heading(north, east, heading)

    def _whole(self, name: str, span: Span, up_to_order: int | None) -> Channel | None:
        return self.tracks.cut(name, span.record_from_s, span.end_s, up_to_order)

    def _airspeed_notes(self, span: Span, up_to_order: int | None) -> list[str]:
        """Return sentences about an air speed without a sensor."""
        if self._who.airspeed_doubt:
            return [self._who.airspeed_doubt]
        if self.tracks.speeds_are_one(span.record_from_s, span.end_s, up_to_order):
            return [
                "Air speed and ground speed are equal in every sample, so one of them is copied from the "
                "other. "
                "If no sensor measured the air speed, wind makes the derivatives wrong."
            ]
        return []


def _trusted(channels: Mapping[str, Channel], distrusts: Sequence[Distrust]) -> dict[str, Channel]:
    """Return the channels without distrusted ones that an estimate does not need."""
    left_out = {distrust.channel for distrust in distrusts if distrust.left_out}
    kept = {name: channel for name, channel in channels.items() if name not in left_out}
    if "a_z" in left_out and "alpha" in kept and kept["alpha"].provenance == "derived":
        # Nothing computes an angle of attack from an accelerometer that stands still.
        kept["alpha"] = replace(kept["alpha"], provenance="unknown")
    return kept


def _middle_s(span: Span) -> float:
    """Return the movement's middle time, s, because a new flight mode arrives up to two seconds late."""
    return 0.5 * (span.start_s + span.end_s)
