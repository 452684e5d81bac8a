"""The sign conventions as a picture: an aircraft from the side, from above and from behind, as SVG."""

from collections.abc import Sequence
from math import cos, radians, sin

_WIDTH, _HEIGHT = 780, 270
_BLUE, _ORANGE, _GREY = "#2b86a8", "#c4553a", "#9a9a9a"
"""Motion, surfaces, and references; a label next to each arrow repeats what the colour says."""
_ARROW = 7.0
"""Length of the head of an arrow."""
_PITCH_DEG, _DEFLECTION_DEG, _SIDESLIP_DEG = 12.0, 26.0, 16.0
"""Angles of the drawing, larger than in flight so that they are seen."""

Point = tuple[float, float]


def signs() -> str:
    """Return the picture: what is positive."""
    return "".join(
        [
            f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" font-size="12" font-family="sans-serif" '
            'fill="currentColor" aria-label="Positive directions of angles, rates and surfaces">',
            *_from_the_side((150.0, 130.0)),
            *_from_above((430.0, 120.0)),
            *_from_behind((650.0, 130.0)),
            "</svg>",
        ]
    )


def _from_the_side(at: Point) -> Sequence[str]:
    """Draw α and q nose up, δe trailing edge down, and a_z down."""
    nose, tail = _from(at, 100.0, -_PITCH_DEG), _from(at, 88.0, 180.0 - _PITCH_DEG)
    edge = _from(tail, 34.0, 180.0 - _PITCH_DEG - _DEFLECTION_DEG)
    straight = _from(tail, 40.0, 180.0 - _PITCH_DEG)
    return (
        _text((at[0], 18.0), "from the side", "middle"),
        _line(tail, nose, "currentColor", 6.0),
        _line(at, _from(at, 120.0, 0.0), _BLUE, 1.5),
        _head(_from(at, 120.0, 0.0), 0.0, _BLUE),
        _text((at[0] + 112.0, at[1] + 18.0), "flight path", "middle"),
        _arc(at, 92.0, 0.0, -_PITCH_DEG, _BLUE),
        _text((at[0] + 108.0, at[1] - 8.0), "+α"),
        _arc(at, 60.0, -35.0, -80.0, _BLUE),
        _text((at[0] + 24.0, at[1] - 62.0), "+q"),
        _line(tail, straight, _GREY, 1.0),
        _line(tail, edge, _ORANGE, 4.0),
        _arc(tail, 30.0, 180.0 - _PITCH_DEG, 180.0 - _PITCH_DEG - _DEFLECTION_DEG, _ORANGE),
        _text((tail[0] - 6.0, tail[1] + 34.0), "+δe", "end"),
        _line(at, _from(at, 62.0, 90.0 - _PITCH_DEG), _BLUE, 1.5),
        _head(_from(at, 62.0, 90.0 - _PITCH_DEG), 90.0 - _PITCH_DEG, _BLUE),
        _text((at[0] + 26.0, at[1] + 64.0), "+a_z"),
        _text((at[0], 230.0), "level flight: a_z = −9.81 m/s²", "middle"),
    )


def _from_above(at: Point) -> Sequence[str]:
    """Draw β with the wind from the right, r nose right, and δr trailing edge left."""
    tail = (at[0], at[1] + 72.0)
    wind = _from(at, 92.0, -90.0 + _SIDESLIP_DEG)
    edge = _from(tail, 30.0, 90.0 + _DEFLECTION_DEG)
    return (
        _text((at[0], 18.0), "from above", "middle"),
        _line(tail, (at[0], at[1] - 70.0), "currentColor", 6.0),
        _line((at[0] - 80.0, at[1]), (at[0] + 80.0, at[1]), "currentColor", 4.0),
        _line(wind, _from(at, 20.0, -90.0 + _SIDESLIP_DEG), _BLUE, 1.5),
        _head(_from(at, 14.0, -90.0 + _SIDESLIP_DEG), 90.0 + _SIDESLIP_DEG, _BLUE),
        _text((wind[0] + 6.0, wind[1] + 4.0), "wind"),
        _arc(at, 76.0, -90.0, -90.0 + _SIDESLIP_DEG, _BLUE),
        _text((at[0] + 6.0, at[1] - 82.0), "+β"),
        _arc(at, 50.0, -50.0, -10.0, _BLUE),
        _text((at[0] + 54.0, at[1] - 24.0), "+r"),
        _line(tail, edge, _ORANGE, 4.0),
        _text((edge[0] - 6.0, edge[1] + 4.0), "+δr", "end"),
        _text((at[0], 250.0), "+δr: trailing edge left", "middle"),
    )


def _from_behind(at: Point) -> Sequence[str]:
    """Draw p right wing down, and δa, which rolls to the left."""
    left, right = (at[0] - 90.0, at[1]), (at[0] + 90.0, at[1])
    return (
        _text((at[0], 18.0), "from behind", "middle"),
        _line(left, right, "currentColor", 4.0),
        f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="9"/>',
        _arc(at, 62.0, -60.0, -15.0, _BLUE),
        _text((at[0] + 62.0, at[1] - 30.0), "+p"),
        _line((at[0] + 48.0, at[1] + 10.0), (at[0] + 78.0, at[1] + 10.0), _ORANGE, 4.0),
        _line((at[0] - 48.0, at[1] - 10.0), (at[0] - 78.0, at[1] - 10.0), _ORANGE, 4.0),
        _text((at[0] + 63.0, at[1] + 30.0), "+δa", "middle"),
        _text((at[0], 230.0), "+δa: right aileron down,", "middle"),
        _text((at[0], 246.0), "rolls to the left", "middle"),
    )


def _from(at: Point, length: float, angle_deg: float) -> Point:
    """Return the point at a distance and an angle; the angle counts clockwise from the right."""
    return at[0] + length * cos(radians(angle_deg)), at[1] + length * sin(radians(angle_deg))


def _line(a: Point, b: Point, colour: str, width: float) -> str:
    return (
        f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" stroke="{colour}" '
        f'stroke-width="{width:g}" stroke-linecap="round"/>'
    )


def _arc(at: Point, radius: float, start_deg: float, end_deg: float, colour: str) -> str:
    """Return an arc with an arrow at its end."""
    a, b = _from(at, radius, start_deg), _from(at, radius, end_deg)
    clockwise = end_deg > start_deg
    path = f"M{a[0]:.1f} {a[1]:.1f} A{radius:g} {radius:g} 0 0 {int(clockwise)} {b[0]:.1f} {b[1]:.1f}"
    arrow = _head(b, end_deg + (90.0 if clockwise else -90.0), colour)
    return f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.5"/>{arrow}'


def _head(tip: Point, angle_deg: float, colour: str) -> str:
    wings = [_from(tip, _ARROW, angle_deg + turned) for turned in (155.0, -155.0)]
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in (tip, *wings))
    return f'<polygon points="{points}" fill="{colour}"/>'


def _text(at: Point, words: str, anchor: str = "start") -> str:
    return f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{anchor}">{words}</text>'
