"""What ``advisor gap --foresee`` prints: no flight yet, but what it could show."""

import json
import math

import click

from advisor.aircraft import Aircraft
from advisor.gap.foresee import Foreseen
from advisor.gap.plan import foresee_plan

_SHOWN = {"_s": (1e3, "ms"), "_rad": (57.29578, "deg"), "_rad_s": (57.29578, "deg/s"), "_m": (1.0, "m")}


def print_foresight(
    aircraft: Aircraft, plan: str, rate_hz: float, amplitude_deg: float, without: str, as_json: bool
) -> int:
    """Print the smallest detectable size and the confusions of every effect; exit code 0."""
    inputs = [name.strip() for name in plan.split(",") if name.strip()]
    absent = [name.strip() for name in without.split(",") if name.strip()]
    found = sorted(foresee_plan(aircraft, inputs, rate_hz, amplitude_deg, absent), key=lambda f: f.effect)
    if as_json:
        click.echo(json.dumps(_document(found), indent=1))
        return 0
    click.echo(f"{len(inputs)} manoeuvres at {rate_hz:g} Hz, {amplitude_deg:g} deg of elevator")
    click.echo(f"{'effect':28s}{'smallest size seen':>20s}   looks like")
    for f in found:
        alike = ", ".join(f"{name.replace('_', ' ')} ({100 * c:.0f} %)" for name, c in f.confused_with)
        click.echo(
            f"{f.effect.replace('_', ' '):28s}{size_of(f):>20s}   {alike}{f' -> {f.add}' if f.add else ''}"
        )
    return 0


def size_of(f: Foreseen) -> str:
    """The smallest size with a unit people use."""
    if not math.isfinite(f.smallest):
        return "not at all"
    if f.parameter.endswith("_per_s"):
        return f"{f.smallest:.3g} 1/s"
    for ending in sorted(_SHOWN, key=len, reverse=True):
        if f.parameter.endswith(ending):
            factor, unit = _SHOWN[ending]
            return f"{factor * f.smallest:.3g} {unit}"
    return f"{f.smallest:.3g}"


def _document(found: list[Foreseen]) -> dict[str, object]:
    return {
        "schema": "advisor.foresee/1",
        "effects": [
            {
                "effect": f.effect,
                "parameter": f.parameter,
                "smallest": f.smallest if math.isfinite(f.smallest) else None,
                "add": f.add,
                "confused_with": [{"effect": name, "cosine": c} for name, c in f.confused_with],
            }
            for f in found
        ],
    }
