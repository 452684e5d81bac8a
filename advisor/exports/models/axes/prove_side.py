"""Proof of ``advisor gap --axis lateral --prove``: improved roll and yaw on manoeuvres that no fit has
used."""

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from advisor.aircraft.aircraft import Aircraft, SideControl
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.analysis.axis_flown import SideCompared, answered, beside_simulator, with_derivatives
from advisor.exports.models.axes.handed_over import behind_found
from advisor.exports.models.flown import flown_model, side_of
from advisor.exports.models.formats.jsbsim_format import FORMAT as JSBSIM
from advisor.exports.models.proof import (
    NUMBERS,
    ImprovedAxis,
    Kept,
    Proof,
    answer_of,
    parted,
    proved,
    refuse_unimproved,
)
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.axis.comparison import compare_axis
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import estimate_axis, predicted
from advisor.oem.estimate import NoEstimate
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import Progress
from advisor.words.quantities import NORMAL_95

_Answer = TypeVar("_Answer")


def prove_side(
    compared: SideCompared,
    fresh: Sequence[Maneuver] | None = None,
    prior: FieldPrior = FIELD,
    progress: Progress = lambda *_: None,
) -> Proof:
    """Return the proof of roll and yaw improved by some manoeuvres and tested on others.

    Parameters
    ----------
    fresh
        Manoeuvres of other logs; None to hold out the last third.

    Raises
    ------
    UnusableInputError
        There are too few manoeuvres, no improvement was found, or the fitted manoeuvres lack a control.
    """
    fitted, kept = (compared.maneuvers, fresh) if fresh is not None else parted(compared.maneuvers)
    fitted, against = beside_simulator(fitted, compared.aircraft, progress)
    diagnosis = _flown(compare_axis(LATERAL, fitted, against, prior))
    refuse_unimproved(diagnosis.improves, diagnosis.sentence, len(fitted))
    behind = behind_found(diagnosis, against)
    plain, improved = (_flown(estimate_axis(LATERAL, fitted, file)) for file in (against, behind))
    present = tuple(cause.name for cause in diagnosis.causes if cause.present)
    parts = (*present, NUMBERS)

    def flown_without(gone: tuple[str, ...]) -> Kept:
        model, servos = (plain, against) if gone else (improved, behind)
        with tempfile.TemporaryDirectory() as folder:
            better = compared.aircraft
            left: tuple[str, ...] = ()
            if gone != parts:
                better, left = _improved(model, against, servos, compared, fitted, Path(folder))
            seen, there = beside_simulator(kept, better, progress)
        theta = np.array([there.model.get(n, x) for n, x in zip(SIDE_PARAMETERS, model.theta, strict=True)])
        gaps = {m.number: _gap(m, model, there, theta) for m in seen}
        floor = {name: fit.noise for name, fit in model.fits[0].items()}

        def answer() -> tuple[str | None, str]:
            again = _flown(compare_axis(LATERAL, seen, there, prior))
            return None if again.verdict == "untested" else again.verdict, again.sentence

        return Kept(float(np.mean([*gaps.values()])), gaps, floor, answer, left)

    return proved(ImprovedAxis(answer_of(diagnosis), parts, [present] if present else [], flown_without))


def _improved(
    estimate: AxisEstimate,
    against: Aircraft,
    servos: Aircraft,
    compared: SideCompared,
    fitted: Sequence[Maneuver],
    folder: Path,
) -> tuple[Aircraft, tuple[str, ...]]:
    """Return the aircraft file with the improved simulator, and the parts that it does not support."""
    given = compared.aircraft
    kind, _, _ = (given.simulator or "linear").partition(":")
    if kind in ("linear", "log"):
        speed = estimate.airspeed_m_s
        read = None if speed is None else air_flown(fitted).read_speed(speed)
        return replace(with_derivatives(servos, estimate, read), simulator="linear"), ()
    ahead: dict[str, Any] = {
        name: _ahead(*(getattr(file, name) for file in (given, against, servos))) for name in LATERAL.inputs
    }
    better = replace(given, **ahead)
    values = zip(SIDE_PARAMETERS, estimate.theta, estimate.std, strict=True)
    wrong = tuple(
        n for n, x, std in values if n in against.model and abs(x - against.model[n]) > NORMAL_95 * std
    )
    model = flown_model(compared.state, given) if kind == "jsbsim" else None
    if model is None or model.side is None:
        return better, wrong
    file = folder / f"{Path(str(given.simulator).partition(':')[2]).stem}.xml"
    side = replace(side_of(estimate, model.side.trim, model.side.air, servos), servos={})
    made = JSBSIM.made(replace(model, pitch=None, side=side), file)
    file.write_text(made.text, encoding="utf-8")
    return replace(better, simulator=f"jsbsim:{file}"), made.left_out


def _ahead(given: SideControl, against: SideControl, side_control: SideControl) -> SideControl:
    """Return the servo to put before a simulator. The servo, with ``against`` behind ``given``, amounts to
    ``found``.
    """

    def less(name: str) -> float:
        first, own, whole = (getattr(servo, name) or 0.0 for servo in (given, against, side_control))
        return max(first + whole - own, 0.0)

    return given if side_control == against else replace(given, lag_s=less("lag_s"), delay_s=less("delay_s"))


def _gap(maneuver: Maneuver, model: AxisEstimate, aircraft: Aircraft, theta: FloatArray) -> float:
    """Return the mean gap over outputs: mean square error over that of the noise, minus 1, at least 0."""
    fits = predicted(LATERAL, maneuver, model, aircraft, theta)
    if isinstance(fits, NoEstimate):
        return 0.0
    # The noise of a prediction is its own error, and tells no gap.
    noise = {name: fit.noise for name, fit in model.fits[0].items()}
    return float(np.mean([max(0.0, (fit.rms / noise[name]) ** 2 - 1.0) for name, fit in fits.items()]))


def _flown(answer: _Answer | NoEstimate) -> _Answer:
    return answered(answer, "Fly aileron and rudder in both parts of the flight.", "--prove: ")
