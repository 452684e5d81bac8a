"""All tracks of one vehicle, and the selection of each channel's source."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from advisor.flight.signals.channels import COMPANION_ALPHA, GIVEN_AIRSPEED, GIVEN_HEIGHT, READINGS, Decoded
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA, DerivedAlpha
from advisor.flight.signals.record import AIR_UNITS, UNITS, Channel
from advisor.flight.signals.track import (
    AS_GROUND_SPEED,
    AS_REPORTED,
    ChannelStatus,
    Course,
    Track,
    true_airspeed,
)

_AIR_S = 10.0
"""Margin around a stretch for the samples of pressure and height, s. Pressure and height may arrive once in a
few seconds."""


class Tracks:
    """All tracks of one vehicle, and the selection of each channel's source.

    Parameters
    ----------
    alpha_source
        Source of α in the aircraft file: ``auto``, ``aoa_ssa``, ``derived``, ``named_value:NAME`` or
        ``none``. With ``none`` the channel is kept as with ``auto``, but no estimate uses it.
    airspeed_m_s
        Air speed from the aircraft file, for a log without air speed, m/s.
    temperature_c
        Air temperature from the aircraft file, deg C; None for the standard atmosphere.
    height_m
        Pressure altitude from the aircraft file, m, for a log without pressure and height.
    logs_true_speed
        Function that returns whether the vehicle reports its true air speed instead of the calibrated one.
    beta_source
        Source of the sideslip in the aircraft file: ``named_value:NAME``, or a source within AOA_SSA.
    """

    def __init__(
        self,
        alpha_source: str,
        airspeed_m_s: float | None = None,
        temperature_c: float | None = None,
        height_m: float | None = None,
        logs_true_speed: Callable[[], bool] = lambda: False,
        beta_source: str = "auto",
    ) -> None:
        self._tracks: dict[tuple[str, str], Track] = {}
        self._derived = DerivedAlpha(self._best, partial(self.cut, "airspeed"), airspeed_m_s)
        self._temperature_c = temperature_c
        self._height_m = height_m
        self._logs_true_speed = logs_true_speed
        self._sources: dict[str, list[str]] = {}
        for reading in READINGS:
            self._sources.setdefault(reading.channel, []).append(reading.source)
        self._sources["airspeed"].append(GIVEN_AIRSPEED)
        named = alpha_source.removeprefix("named_value:")
        self._sources["alpha"] = {
            "auto": ["AOA_SSA.AOA", COMPANION_ALPHA, DERIVED_ALPHA],
            "none": ["AOA_SSA.AOA", COMPANION_ALPHA, DERIVED_ALPHA],
            "aoa_ssa": ["AOA_SSA.AOA", COMPANION_ALPHA],
            "derived": [DERIVED_ALPHA],
        }.get(alpha_source, [f"NAMED_VALUE_FLOAT.{named}"])
        if beta_source.startswith("named_value:"):
            self._sources["beta"] = [f"NAMED_VALUE_FLOAT.{beta_source.removeprefix('named_value:')}"]

    def clear(self) -> None:
        """Drop all samples before another power-on."""
        self._tracks.clear()

    def forget(self, before_s: float) -> None:
        """Drop samples older than ``before_s`` when room is needed."""
        for track in self._tracks.values():
            track.forget(before_s)

    def append(self, new: Decoded) -> None:
        """Take samples of one channel from one source."""
        key = (new.channel, new.source)
        if len(new.t) == 0:
            return
        if key not in self._tracks:
            self._tracks[key] = Track(new.channel, new.source, new.provenance)
        self._tracks[key].append(new.t, new.y, new.order)

    def serves(self, new: Decoded) -> bool:
        """Return whether a source may give the channel."""
        return new.source in self._sources.get(new.channel, (new.source,))

    @property
    def derives_alpha(self) -> bool:
        """Whether the angle of attack may be derived."""
        return DERIVED_ALPHA in self._sources["alpha"]

    def cut(self, name: str, start_s: float, end_s: float, up_to_order: int | None = None) -> Channel | None:
        """Return a stretch of a channel from the best source with samples there; None without samples. The
        air speed is converted to the true one as far as the log allows."""
        channel = self._cut(name, start_s, end_s, up_to_order)
        if name != "airspeed" or channel is None:
            return channel
        air = (self._cut(n, start_s - _AIR_S, end_s + _AIR_S, up_to_order) for n in AIR_UNITS)
        by_name = {channel.name: channel for channel in air if channel is not None}
        # With a static pressure an aircraft reads its air speed from a pitot tube, and knows no true one.
        if self._logs_true_speed() and "static_pressure" not in by_name:
            return replace(channel, source=f"{channel.source}{AS_REPORTED}")
        if self._speeds_agree(start_s, end_s, up_to_order):
            return replace(channel, source=f"{channel.source}{AS_GROUND_SPEED}")
        return true_airspeed(
            channel, by_name.get("static_pressure"), by_name.get("altitude"), self._temperature_c
        )

    def _cut(self, name: str, start_s: float, end_s: float, up_to_order: int | None) -> Channel | None:
        spare = None
        for track in self._candidates(name):
            channel = track.cut(start_s, end_s, up_to_order)
            if len(channel) < 2:
                continue
            if np.ptp(channel.y) > 0.0:
                return _in_radians(channel)
            # No barometer stands still: a constant pressure is a default.
            spare = spare or (None if name == "static_pressure" else channel)
        if spare is None and name == "altitude" and self._height_m is not None:
            ends = np.array([start_s, end_s])
            return Channel(name, ends, np.full(2, self._height_m), GIVEN_HEIGHT, "given")
        return spare

    def speeds_are_one(self, start_s: float, end_s: float, up_to_order: int | None) -> bool:
        """Return whether air speed and ground speed change and are equal in every sample of a stretch."""
        air = self._cut("airspeed", start_s, end_s, up_to_order)
        if air is None or float(np.ptp(air.y)) == 0.0 or self._logs_true_speed():
            return False
        return self._speeds_agree(start_s, end_s, up_to_order)

    def _speeds_agree(self, start_s: float, end_s: float, up_to_order: int | None) -> bool:
        """Return whether air speed and ground speed are equal in every sample, unlike two instruments."""
        air, ground = (self._cut(name, start_s, end_s, up_to_order) for name in ("airspeed", "groundspeed"))
        if air is None or ground is None:
            return False
        return np.array_equal(air.t, ground.t) and np.array_equal(air.y, ground.y)

    def recent(self, name: str, seconds: float) -> Channel | None:
        """Return the newest stretch of a channel, ``seconds`` long; None without samples."""
        newest = max((track.newest_s for track in self._candidates(name)), default=None)
        return None if newest is None else self.cut(name, newest - seconds, newest)

    def statuses(self) -> dict[str, ChannelStatus]:
        """Return the arrival status of every channel, from its best source."""
        best = {name: next(iter(self._candidates(name)), None) for name in UNITS}
        return {name: track.status for name, track in best.items() if track is not None}

    def courses(self) -> dict[str, Course]:
        """Return the extremes of each channel over this power-on, from its best measured source."""
        best = {name: next(iter(self._candidates(name)), None) for name in UNITS}
        return {name: track.extremes.course for name, track in best.items() if isinstance(track, Track)}

    def _candidates(self, name: str) -> list[Track | DerivedAlpha]:
        """Return the possible tracks of a channel, the preferred source first."""
        preferred = self._sources.get(name)
        if preferred is None:
            return [track for (channel, _), track in self._tracks.items() if channel == name]
        tracks: list[Track | DerivedAlpha] = []
        for source in preferred:
            if (name, source) in self._tracks:
                tracks.append(self._tracks[name, source])
            elif source == DERIVED_ALPHA and self._derived.exists:
                tracks.append(self._derived)
        return tracks

    def _best(self, name: str) -> Track | None:
        """Return the track of the best measured source of a channel; None without samples."""
        tracks = (self._tracks.get((name, source)) for source in self._sources[name])
        return next((track for track in tracks if track is not None), None)


_LARGEST_ALPHA_RAD = 0.7
"""Largest plausible angle of attack in a named value, rad. No short period is flown at 40 degrees, so a
larger named value is in degrees."""


def _in_radians(channel: Channel) -> Channel:
    """Return a vane's channel in radians. A named value has no stated unit, so its size decides."""
    if not channel.source.startswith("NAMED_VALUE_FLOAT") or np.max(np.abs(channel.y)) <= _LARGEST_ALPHA_RAD:
        return channel
    return replace(channel, y=np.radians(channel.y))
