"""Format ``jsbsim``: a copy of the user's own JSBSim aircraft, corrected in both axes.

A derivative is corrected if its 95 % interval excludes the prior value. The prior value comes from the
aircraft file's ``model``, else from the JSBSim aircraft. A function of the dynamic pressure
and of α, q or elevator about the trim is added. The aircraft's own tables and its trim stay.

The nonlinear functions of effects are those of the aircraft file. Their squares and cubes are of α or of the
elevator, and one moment depends on α̇. These terms are relative to ``about_rad``, or else to the trim. All
terms are proportional to the dynamic pressure.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.formats import AxisAsked, ModelFormat
from advisor.exports.models.improvement import (
    SLOPES,
    Exported,
    ExportedServo,
    Improvement,
    effects_beside,
    is_told,
    zero_said,
)
from advisor.exports.models.jsbsim.axes.side_text import side_text
from advisor.exports.models.jsbsim.slopes import Request, Slopes
from advisor.exports.models.jsbsim.source import (
    AXES,
    PLAIN,
    SURFACES,
    AddedFunction,
    Model,
    corrected,
    measure,
    model_of,
    parse,
    settled,
    surface_of,
)
from advisor.gap.effects import EFFECTS
from advisor.words.problems import ConfigurationError


def aircraft_text(improvement: Improvement, model: Model) -> Exported:
    """Return the corrected aircraft, measured at the flown speed and height, or at sea level if unknown.

    Raises
    ------
    ConfigurationError
        The aircraft does not load or trim at the flown speed, or cannot be corrected.
    """
    content, name = model.file.read_bytes(), model.file.name
    surface = surface_of(parse(content, name))
    asked = Request(improvement.true_airspeed_m_s, improvement.air.height_m or 0.0, surface=surface)

    def measured(added: Sequence[AddedFunction]) -> Slopes:
        # Measured without the servo, because backlash and dead band would hide a small deflection.
        return measure(corrected(content, name, added, ExportedServo(), "").encode(), model, asked)

    first = measure(content, model, asked)
    if not first.powered:
        # A failed trim leaves the engines in any state, and costs time.
        asked = replace(asked, powered=False)
        first = measure(content, model, asked)
    targets = _targets(improvement, first, SURFACES.get(surface))
    changes, now = settled(
        first, targets, partial(_loads, own=first), partial(_functions, own=first, surface=surface), measured
    )
    # Effects come last, because their contributions at the trim were found in addition to these.
    added, carried = functions_of(improvement.effects, now, surface)
    servo = replace(improvement.servo, lag_s=max(improvement.servo.lag_s, 0.0))
    text = corrected(content, name, [*changes, *added], servo, _note(improvement, first, targets))
    zeros = [zero_said(p) for p in targets if not is_told(improvement.model[p]) and targets[p] == 0.0]
    left = (*_left_out(improvement, surface), *zeros, *effects_beside(improvement, *carried))
    return Exported(text, left)


def _left_out(improvement: Improvement, surface: str) -> list[str]:
    """Return the parts of servo and derivatives that the aircraft does not support."""
    servo = improvement.servo
    left = ["a lag below the model's own"] if servo.lag_s < 0.0 else []
    if servo.damping and servo.lag_s > 0.0:
        left.append(f"the servo's damping of {servo.damping:.2g}, which is 1 here")
    if surface not in SURFACES:
        # Per radian in flight, per full travel in the aircraft.
        unknown = [p for p in SLOPES if p.endswith("delta_e") and p not in improvement.prior]
        left += [f"{p}: the elevator's position is no angle" for p in unknown]
    return left


def _targets(improvement: Improvement, first: Slopes, per_rad: float | None) -> dict[str, float]:
    """Return the target of each contradicted derivative; None if the elevator's property is no angle."""
    targets = {}
    for parameter in SLOPES:
        own = first.derivatives[parameter]
        unit = (per_rad or math.nan) if parameter.endswith("delta_e") else 1.0
        prior = improvement.prior.get(parameter, own * unit)
        value = improvement.number(parameter)
        if improvement.differs(parameter, prior) and not math.isnan(prior):
            # By an elevator without an angle, only the ratio is known.
            by_ratio = value == 0.0 or (prior != 0.0 and math.isnan(unit))
            targets[parameter] = value and own * value / prior if by_ratio else own + (value - prior) / unit
    moved = ["M" + parameter[1:] for parameter in targets if parameter[0] == "Z"]
    return targets | {
        parameter: first.derivatives[parameter] for parameter in moved if parameter not in targets
    }


def _loads(missing: Mapping[str, float], own: Slopes) -> dict[str, float]:
    """Return the value of each derivative's additional function, lbs or lbs·ft."""
    time_s = {"q": own.chord_time_s}
    return {
        name: size / (own.per_force(name[0]) * own.pressure_psf * time_s.get(name[2:], 1.0))
        for name, size in missing.items()
    }


def _functions(sizes: Mapping[str, float], own: Slopes, surface: str) -> list[AddedFunction]:
    """Return functions about the trim, which they leave as it is."""
    return [
        AddedFunction(
            name, AXES[name[0]], size, surface if name.endswith("delta_e") else PLAIN[name[2:]],
            own.trim[name[2:]], further="aero/ci2vel" if name[2:] == "q" else "",
        )
        for name, size in sizes.items()
        if size
    ]  # fmt: skip


def _note(improvement: Improvement, first: Slopes, targets: Mapping[str, float]) -> str:
    """Return the comment at the top: the changes, and the flight condition in which they are valid."""
    changed = [f"{p} {first.derivatives[p]:.4g} becomes {target:.4g}" for p, target in targets.items()]
    servo = improvement.servo.lines() or ["as it was"]
    return (
        f"Corrected by advisor gap for {improvement.name} at {improvement.true_airspeed_m_s:.4g} m/s. "
        f"Derivatives (SI): {', '.join(changed) or 'as they were'}. Servo: {', '.join(servo)}."
    )


def functions_of(
    effects: Mapping[str, Mapping[str, float]], slopes: Slopes, surface: str
) -> tuple[list[AddedFunction], list[str]]:
    """Return the functions for effects, and the names of completely represented effects."""
    functions: list[AddedFunction] = []
    carried = []
    for effect, values in effects.items():
        curve = EFFECTS[effect].curve
        if curve is None or not values.keys() <= {*curve.powers, "about_rad"}:
            # A separated flow has further parameters, which no square and no cube expresses.
            continue
        variable, powers = curve.variable, curve.powers
        unit = SURFACES.get(surface) if variable == "delta_e" else 1.0
        if variable == "alpha_dot":
            strength = values["M_alpha_dot"] * slopes.inertia / slopes.pressure_psf / slopes.chord_time_s
            functions.append(
                AddedFunction(effect, "PITCH", strength, "aero/alphadot-rad_sec", further="aero/ci2vel")
            )
            carried.append(effect)
        elif unit is not None:
            about = unit * values["about_rad"] if "about_rad" in values else slopes.trim[variable]
            functions += [
                AddedFunction(
                    name,
                    AXES[name[0]],
                    values[name] / unit**power / (slopes.per_force(name[0]) * slopes.pressure_psf),
                    surface if variable == "delta_e" else PLAIN[variable],
                    about,
                    power,
                )
                for name, power in powers.items()
                if values.get(name)
            ]
            carried.append(effect)
    return functions, carried


class JsbsimFormat(ModelFormat):
    """The JSBSim aircraft of ``simulator: jsbsim:MODEL``, corrected."""

    suffix = ".xml"
    needs_a_finding = True

    def refuse(self, file: Path, aircraft: Aircraft, axis: AxisAsked) -> None:
        """Refuse an aircraft file without a JSBSim aircraft, and the replacement of that aircraft."""
        if file.resolve() == _model(aircraft).file:
            raise ConfigurationError(
                f"--export jsbsim: {file} is the simulator's own aircraft; name another file."
            )

    def made(self, model: FlownModel, file: Path) -> Exported:
        """Return the aircraft with pitch corrected, then roll and yaw."""
        own = _model(model.aircraft)
        content, left = own.file.read_bytes(), []
        if model.pitch is not None:
            made = aircraft_text(model.pitch, own)
            content, left = made.text.encode(), [*made.left_out]
        if model.side is not None and model.side.flown:
            made = side_text(model.name, model.side, own, content)
            content, left = made.text.encode(), [*left, *made.left_out]
        return Exported(content.decode(), tuple(left))


def _model(aircraft: Aircraft) -> Model:
    """Return the user's JSBSim aircraft, from the specification of the simulator."""
    kind, _, what = (aircraft.simulator or "").partition(":")
    if kind != "jsbsim" or not what:
        raise ConfigurationError(
            "--export jsbsim corrects a JSBSim aircraft: give yours with simulator: jsbsim:MODEL in the "
            "aircraft file."
        )
    return model_of(what)


FORMAT = JsbsimFormat()
