"""Flight modes: their names, and who moves the elevator in each."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import inf, isfinite

_PLANE = {
    0: "MANUAL", 1: "CIRCLE", 2: "STABILIZE", 3: "TRAINING", 4: "ACRO", 5: "FBWA", 6: "FBWB", 7: "CRUISE",
    8: "AUTOTUNE", 10: "AUTO", 11: "RTL", 12: "LOITER", 13: "TAKEOFF", 14: "AVOID_ADSB", 15: "GUIDED",
    16: "INITIALISING", 17: "QSTABILIZE", 18: "QHOVER", 19: "QLOITER", 20: "QLAND", 21: "QRTL",
    22: "QAUTOTUNE", 23: "QACRO", 24: "THERMAL", 25: "LOITER_ALT_QLAND", 26: "AUTOLAND",
}  # fmt: skip
"""Name of each custom mode of ArduPlane (``mode.h``)."""
_COPTER = {
    0: "STABILIZE", 1: "ACRO", 2: "ALT_HOLD", 3: "AUTO", 4: "GUIDED", 5: "LOITER", 6: "RTL", 7: "CIRCLE",
    9: "LAND", 11: "DRIFT", 13: "SPORT", 14: "FLIP", 15: "AUTOTUNE", 16: "POSHOLD", 17: "BRAKE", 18: "THROW",
    19: "AVOID_ADSB", 20: "GUIDED_NOGPS", 21: "SMART_RTL", 22: "FLOWHOLD", 23: "FOLLOW", 24: "ZIGZAG",
    25: "SYSTEMID", 26: "AUTOROTATE", 27: "AUTO_RTL",
}  # fmt: skip
"""Name of each custom mode of ArduCopter (``mode.h``)."""
_PX4 = {
    1: "Manual", 2: "Altitude", 3: "Position", 4: "Auto", 5: "Acro", 6: "Offboard", 7: "Stabilized",
    8: "Rattitude", 10: "Termination", 11: "Altitude Cruise",
}  # fmt: skip
"""Name of each main mode of PX4 (``px4_custom_mode.h``)."""
_PX4_SUB = {
    (3, 1): "Orbit", (3, 2): "Position Slow", (4, 1): "Ready", (4, 2): "Takeoff", (4, 3): "Hold",
    (4, 4): "Mission", (4, 5): "Return", (4, 6): "Land", (4, 8): "Follow Me", (4, 9): "Precision Land",
    (4, 10): "VTOL Takeoff",
}  # fmt: skip
"""Name of each pair of main and sub mode of PX4, for Position and Auto."""
_MANUAL = frozenset({_PLANE[0], _PX4[1]})
_KNOWN = frozenset({*_PLANE.values(), *_COPTER.values(), *_PX4.values(), *_PX4_SUB.values()})
_ERRANDS = frozenset({
    "TAKEOFF", "RTL", "CIRCLE", "THERMAL", "AVOID_ADSB", "AUTOLAND",
    "Takeoff", "VTOL Takeoff", "Return", "Land", "Precision Land", "Orbit", "Follow Me", "Termination",
})  # fmt: skip
"""Modes in which the autopilot flies its own task, so that no test input is flown."""
_HOVER = ", hovering"
_HOVERING = frozenset(name for name in _PLANE.values() if name.startswith("Q") or name.endswith("QLAND"))
_COPTERS = frozenset({2, 3, 4, 13, 14, 15, 29, 35})
"""Values of MAV_TYPE for which ArduPilot is ArduCopter."""


def mode_name(autopilot: str, kind: int, custom: int) -> str:
    """Return the flight mode's name in the autopilot's documentation, or its number if unknown.

    Parameters
    ----------
    autopilot
        Name of the autopilot: ``ardupilot``, ``px4``, or another.
    kind
        MAV_TYPE.
    custom
        Value of HEARTBEAT.custom_mode. ArduPilot sends the number of the mode. PX4 sends the main mode in
        bits 16 to 23 and the sub mode in bits 24 to 31.
    """
    names: dict[int, str] = {}
    if autopilot == "ardupilot":
        names = _COPTER if kind in _COPTERS else _PLANE
    if autopilot == "px4":
        main, sub = custom >> 16 & 0xFF, custom >> 24 & 0xFF
        return _PX4_SUB.get((main, sub), _PX4.get(main, f"mode {custom}"))
    return names.get(custom, f"mode {custom}")


def in_hover(mode: str) -> str:
    """Return the mode's name with the addition that rotors carry the VTOL aircraft."""
    return mode + _HOVER


def hovers(mode: str) -> bool:
    """Return whether rotors carry the aircraft in this mode; False for an unknown mode."""
    return mode in _HOVERING or mode.endswith(_HOVER)


def is_manual(mode: str) -> bool:
    """Return whether the pilot moves the elevator directly in this mode."""
    return mode in _MANUAL


def closes_pitch_loop(mode: str) -> bool:
    """Return whether the autopilot closes a pitch loop in this mode; False for an unknown mode.

    The loop correlates elevator, angle of attack and pitch rate.
    """
    return hovers(mode) or (mode in _KNOWN - {"INITIALISING"} and not is_manual(mode))


def has_an_errand(mode: str) -> bool:
    """Return whether the autopilot takes off, lands, returns, circles or hovers in this mode."""
    return mode in _ERRANDS or hovers(mode)


def stays(
    changes: Sequence[tuple[float, str]], begin_s: float, end_s: float
) -> Iterator[tuple[float, float, str]]:
    """Yield begin, end and mode of each stay in a flight mode between two times, s since boot.

    Parameters
    ----------
    changes
        Begin of each mode, never falling, and its name. A time that is not finite lies before the first time.
    """
    named = [(max(t, begin_s) if isfinite(t) else begin_s, name) for t, name in changes]
    for (start_s, name), (next_s, _) in pairwise([*named, (inf, "")]):
        if name and min(next_s, end_s) > start_s:
            yield start_s, min(next_s, end_s), name
