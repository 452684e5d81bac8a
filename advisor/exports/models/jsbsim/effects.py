"""Effects of force and pitching moment as functions of a JSBSim aircraft.

The curves are those of the aircraft file's ``effects``. Squares and cubes are of α or of the elevator; a
moment is by the rate of α. They count from ``about_rad`` or else from the trim. All are proportional to the
dynamic pressure.
"""

from collections.abc import Mapping

from advisor.exports.models.jsbsim.slopes import Slopes
from advisor.exports.models.jsbsim.source import AXES, PLAIN, SURFACES, AddedFunction
from advisor.gap.effects import EFFECTS


def functions_of(
    effects: Mapping[str, Mapping[str, float]], slopes: Slopes, surface: str
) -> tuple[list[AddedFunction], list[str]]:
    """Return the functions, and the names of the effects that the functions carry completely.

    Parameters
    ----------
    effects
        Effects of the aircraft file.
    slopes
        Slopes of the aircraft that receives the functions.
    surface
        Property of the elevator's position.
    """
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
