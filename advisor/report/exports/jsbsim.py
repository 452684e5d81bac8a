"""A copy of the user's JSBSim aircraft that has the derivatives and the servo found.

A derivative is corrected where its 95 % interval excludes what the simulator believed: what the aircraft
file's ``model`` says, else what the JSBSim aircraft itself does. Its own terms are multiplied. A function is
added where it has none, or where the factor would turn their sign. The corrected aircraft is loaded and
measured again until each derivative is the one asked for: lift acts on the moment as well, by its arm.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from advisor.problems import ConfigurationError
from advisor.report.exports.exported import Exported, effects_beside
from advisor.report.exports.improvement import SLOPES, Improvement
from advisor.report.exports.jsbsim_model import SURFACES, Knob, corrected, parse, surface_of, terms_of
from advisor.report.exports.jsbsim_slopes import Slopes

TIME_LIMIT_S = 60.0
"""For loading and measuring one aircraft once, which takes less than a second."""
ROUNDS = 8
"""In which the factors settle; each divides what is left by ten or more."""
WITHIN = 1e-3
"""Relative error of a derivative at which the corrected aircraft is as asked for."""
_COLUMNS = ("alpha", "q", "delta_e")


@dataclass(frozen=True)
class Model:
    """Where a JSBSim aircraft and what it needs lie."""

    file: Path
    engine: Path
    systems: Path

    @property
    def name(self) -> str:
        """JSBSim's name of the aircraft: that of its file."""
        return self.file.stem


def find_model(what: str) -> Model:
    """The aircraft that ``jsbsim:`` names: a file, or one of the installed package.

    Raises
    ------
    ConfigurationError
        JSBSim is not installed, or has no such aircraft.
    """
    try:
        import jsbsim
    except ImportError as error:
        raise ConfigurationError(
            "--export jsbsim needs JSBSim: pip install 'inflight-advisor[jsbsim]'."
        ) from error
    root = Path(jsbsim.get_default_root_dir())
    given = Path(what)
    file = given if given.suffix.lower() == ".xml" else root / "aircraft" / what / f"{what}.xml"
    if not file.is_file():
        raise ConfigurationError(
            f"--export jsbsim: there is no aircraft {what}; name one of JSBSim's (c172p) or the path of an "
            ".xml file."
        )
    own = file.resolve().parents[:3]
    engine, systems = (
        next((up / name for up in own if (up / name).is_dir()), root / name) for name in ("engine", "systems")
    )
    return Model(file.resolve(), engine, systems)


def aircraft_text(improvement: Improvement, model: Model) -> Exported:
    """The corrected aircraft, measured at the speed and height flown; at sea level where that is not known.

    Raises
    ------
    ConfigurationError
        The aircraft does not load or trim at the speed flown, or cannot be corrected.
    """
    content, name = model.file.read_bytes(), model.file.name
    root = parse(content, name)
    terms = terms_of(root)
    asked = {
        "names": [n for parameter in SLOPES for n in terms.get(parameter, ())],
        "surface": surface_of(root),
        "airspeed_m_s": improvement.airspeed_m_s,
        "height_m": improvement.height_m or 0.0,
    }
    first = _measure(content.decode("utf-8", "surrogateescape"), model, asked)
    targets = _targets(improvement, first, terms, SURFACES.get(surface_of(root)))
    servo = replace(improvement.servo, lag_s=max(improvement.servo.lag_s, 0.0))
    note = _note(improvement, first, targets)
    knobs = [_knob(parameter, terms.get(parameter, ()), first) for parameter in targets]
    now = first
    for _ in range(ROUNDS):
        text = corrected(content, name, tuple(knob for knob, _ in knobs), servo, note)
        now = _measure(text, model, asked) if knobs else first
        if all(_is_close(now.derivatives[p], target) for p, target in targets.items()):
            break
        knobs = [
            _turned(knob, gain, targets[knob.parameter] - now.derivatives[knob.parameter], first)
            for knob, gain in knobs
        ]
    else:
        off = next(p for p, target in targets.items() if not _is_close(now.derivatives[p], target))
        raise ConfigurationError(
            f"--export jsbsim: {name} cannot be given {off} = {targets[off]:.4g} by its own terms; "
            "use --export matlab or aircraft."
        )
    left = ["a lag below the model's own"] if improvement.servo.lag_s < 0.0 else []
    if servo.damping and servo.lag_s > 0.0:
        left.append(f"the servo's damping of {servo.damping:.2g}, which is 1 here")
    left += [f"{p}: the elevator's position is no angle" for p in _unmeasured(improvement, surface_of(root))]
    return Exported(text, (*left, *effects_beside(improvement)))


def _targets(
    improvement: Improvement, first: Slopes, terms: Mapping[str, Sequence[str]], per_rad: float | None
) -> dict[str, float]:
    """Derivative to the value that the aircraft shall have: those contradicted, and moments that lift moves.

    ``per_rad`` is how many units of the elevator's property are a radian; None: the property is no angle.
    """
    found = {}
    for parameter in SLOPES:
        own = first.derivatives[parameter]
        unit = (per_rad or math.nan) if parameter.endswith("delta_e") else 1.0
        believed = improvement.believed.get(parameter, own * unit)
        value = improvement.model[parameter].value
        if improvement.differs(parameter, believed) and not math.isnan(believed):
            # A term is changed by the ratio: the file's numbers may belong to another density of the air.
            by_difference = own + (value - believed) / unit
            found[parameter] = own * value / believed if believed and parameter in terms else by_difference
    moved = ["M" + parameter[1:] for parameter in found if parameter[0] == "Z"]
    return found | {parameter: first.derivatives[parameter] for parameter in moved if parameter not in found}


def _unmeasured(improvement: Improvement, surface: str) -> list[str]:
    """Derivatives that cannot be compared: per radian as flown, per full travel in the aircraft."""
    if surface in SURFACES:
        return []
    return [p for p in SLOPES if p.endswith("delta_e") and p not in improvement.believed]


def _knob(parameter: str, terms: Sequence[str], first: Slopes) -> tuple[Knob, float]:
    """A knob that changes nothing yet, and how much of the derivative a unit of it makes."""
    variable = parameter[2:]
    column = _COLUMNS.index(variable)
    per_force = -1.0 / first.momentum if parameter[0] == "Z" else 1.0 / first.inertia
    share = per_force * sum(first.shares[name][column] for name in terms)
    if share == 0.0:
        return Knob(parameter, (), 0.0, first.pressure_psf, first.trim[variable]), per_force
    return Knob(parameter, tuple(terms), 1.0, first.pressure_psf, 0.0), share


def _turned(knob: Knob, gain: float, missing: float, first: Slopes) -> tuple[Knob, float]:
    """The knob turned by what is missing; a factor below zero becomes an added function."""
    value = knob.value + missing / gain
    if knob.terms and value <= 0.0:
        added, per_force = _knob(knob.parameter, (), first)
        return replace(added, value=(missing + (knob.value - 1.0) * gain) / per_force), per_force
    return replace(knob, value=value), gain


def _is_close(value: float, target: float) -> bool:
    return math.isclose(value, target, rel_tol=WITHIN, abs_tol=1e-6)


def _note(improvement: Improvement, first: Slopes, targets: Mapping[str, float]) -> str:
    """The comment on top: what changed, in the condition in which that holds."""
    changed = [f"{p} {first.derivatives[p]:.4g} becomes {target:.4g}" for p, target in targets.items()]
    servo = improvement.servo.lines() or ["as it was"]
    return (
        f"Corrected by advisor gap for {improvement.name} at {improvement.airspeed_m_s:.4g} m/s. "
        f"Derivatives (SI): {', '.join(changed) or 'as they were'}. Servo: {', '.join(servo)}."
    )


def _measure(text: str, model: Model, asked: Mapping[str, object]) -> Slopes:
    """Load a text as the aircraft of that name, beside the files that it includes, and measure it."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / model.name
        place.mkdir()
        for entry in model.file.parent.iterdir():
            if entry.name != f"{model.name}.xml":
                (place / entry.name).symlink_to(entry)
        (place / f"{model.name}.xml").write_text(text, encoding="utf-8", errors="surrogateescape")
        request = {
            **asked, "model": model.name, "aircraft": folder,
            "engine": str(model.engine), "systems": str(model.systems),
        }  # fmt: skip
        try:
            done = subprocess.run(
                [sys.executable, "-m", "advisor.report.exports.jsbsim_slopes"],
                input=json.dumps(request), capture_output=True, text=True, timeout=TIME_LIMIT_S, check=True,
                cwd=folder, env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            )  # fmt: skip
            return Slopes(**json.loads(done.stdout.splitlines()[-1]))
        except (subprocess.SubprocessError, ValueError, IndexError, TypeError) as error:
            raise ConfigurationError(
                f"--export jsbsim: JSBSim does not load and trim {model.file.name} at "
                f"{asked['airspeed_m_s']:.4g} m/s; check the aircraft, and the air speed of the log."
            ) from error
