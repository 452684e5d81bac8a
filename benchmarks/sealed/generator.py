"""What a generator of flights from outside needs beside its physics: its command, its files, its key."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np

from sim.sealed.cases import SealedCase, key_beside, write_set

COMPARED = (
    "delay_s", "lag_s", "half_width_rad", "rate_rad_s", "scale", "bias_rad", "bias_rad_s", "arm_m", "skew_s",
)  # fmt: skip
"""Sizes that the contract gives a name, a unit and a sign. ``skew_s`` is positive when values are older than
their stamps, ``scale`` is the departure from one, ``arm_m`` is positive ahead of the centre of gravity."""

Draw = Callable[[int, int, str | None], Iterable[SealedCase]]
"""Cases from a number, a seed, and a class or an effect to draw alone. ValueError: there is no such class."""
Entered = tuple[str, str, Mapping[str, Any]]
"""An effect of a case, its block and its sizes."""


def command(draw: Draw, name: str) -> click.Command:
    """Return the command line of the generator that ``python -m name`` runs."""

    @click.command(
        help=f"""Write sealed flights, and their key beside the folder.

        \b
        python -m {name} --cases 160 --seed 11 --out cases
        python -m benchmarks.sealed.answer cases answers.jsonl
        python -m sim commit cases answers.jsonl
        python -m sim reveal cases answers.jsonl --details
        """
    )
    @click.option("--cases", type=click.IntRange(1), required=True, help="Number of cases.")
    @click.option("--seed", type=click.IntRange(0), required=True, help="Equal seeds give equal flights.")
    @click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder for the cases.")
    @click.option("--only", help="A class (none, one, two, parameters, outside) or an effect.")
    def drawing(cases: int, seed: int, out: Path, only: str | None) -> None:
        try:
            digest = write_set(out, draw(cases, seed, only))
        except ValueError as error:
            raise click.UsageError(str(error)) from error
        click.echo(f"sealed {cases} cases, key {key_beside(out)}, hash {digest}", err=True)

    return drawing


def aircraft_file(
    name: str,
    calibration: Sequence[tuple[float, float]],
    servo: tuple[float | None, float | None],
    arms_m: tuple[float | None, float | None],
    airspeed_m_s: float,
    reference: tuple[float, float, float, float],
    model: Mapping[str, float] | None,
) -> dict[str, Any]:
    """Return what a crew knows of its aircraft.

    Parameters
    ----------
    servo
        Lag and delay, s. None: not stated.
    arms_m
        Places of vane and accelerometer ahead of the centre of gravity. None: not stated.
    reference
        Mass [kg], wing area [m²], chord [m], moment of inertia in pitch [kg m²].
    """
    document: dict[str, Any] = {
        "name": name,
        "elevator": {
            "output": "auto",
            "calibration": [list(point) for point in calibration],
            "lag_s": _rounded(servo[0]),
            "delay_s": _rounded(servo[1]),
        },
        "alpha": {"source": "auto", "vane_arm_m": _rounded(arms_m[0])},
        "accelerometer": {"arm_m": _rounded(arms_m[1])},
        "airspeed_m_s": None,
        "reference_airspeed_m_s": _rounded(airspeed_m_s),
        "reference": dict(
            zip(("mass_kg", "wing_area_m2", "chord_m", "iyy_kg_m2"), map(_rounded, reference), strict=True)
        ),
    }
    if model is not None:
        document["model"] = {derivative: _rounded(value) for derivative, value in model.items()}
    return document


def quiet_factor(seed: int, least: float) -> float:
    """Return a factor on the noise of a flight, drawn between ``least`` and 1, evenly in the logarithm."""
    return float(np.exp(np.random.default_rng([seed, 79]).uniform(np.log(least), 0.0)))


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.5g}")


def truth(
    kind: str,
    condition: str,
    effects: Sequence[Entered],
    background: Sequence[str],
    gap: float | None = None,
    **facts: Any,
) -> dict[str, Any]:
    """Return what is true of a case, with the keys of ``sim.sealed.judge``; the facts are for readers."""
    return {
        "kind": kind,
        "condition": condition,
        "effects": {
            name: {size: float(value) for size, value in sizes.items() if size in COMPARED}
            for name, _, sizes in effects
        },
        "blocks": [block for _, block, _ in effects],
        "gap": gap,
        "background": list(background),
        **facts,
    }
