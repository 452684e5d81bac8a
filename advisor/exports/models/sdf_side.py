"""Gazebo's roll and yaw: one ``gz::sim::systems::AdvancedLiftDrag`` plugin without lift and pitching moment.

Its conventions, from its source (``src/systems/advanced_lift_drag``):

- coefficients of β and of the rates p·b/(2·V), r·b/(2·V) are per radian, those of a joint per degree;
- roll is positive right wing down, yaw positive nose right, and β positive with wind from the right;
- torques act on the link's inertia, so the products of inertia are taken out of L and N:
  l = I_xx·L − I_xz·N and n = I_zz·N − I_xz·L;
- the plugin sets the pitching moment of α to zero (it assigns ``Cemb``·β), so that pitch stays with the wing
  and the tail of ``advisor.exports.models.sdf``.
"""

import math

from advisor.aircraft.reference import Reference
from advisor.exports.models.exported import Exported, xml_comment
from advisor.exports.models.flown import SideModel
from advisor.exports.models.improvement import air_note

SIDE_KEYS = ("mass_kg", "wing_area_m2", "span_m", "ixx_kg_m2", "izz_kg_m2")
JOINTS = {"delta_a": "aileron_joint", "delta_r": "rudder_joint"}
_NO_STALL_RAD = 1.5
"""Angle of attack at which the plugin adds a flat plate's lift, rad: beyond every flight."""
_ANY_EFFICIENCY = 0.9
"""Factor of the induced drag, which is zero without lift. The plugin divides by it."""

Triple = tuple[float, float, float]
"""Coefficients of side force, roll and yaw."""


def side_block_text(name: str, reference: Reference, side: SideModel) -> Exported:
    """Return the plugin of roll and yaw; ``reference`` has the keys of ``SIDE_KEYS``."""
    area, span = reference.wing_area_m2 or math.nan, reference.span_m or math.nan
    c = {factor: _coefficients(factor, side, reference) for factor in ("beta", "p", "r", *JOINTS)}
    numbers = {
        "air_density": side.air.density_kg_m3, "area": area, "AR": span**2 / area,
        "mac": reference.chord_m or area / span, "eff": _ANY_EFFICIENCY, "alpha_stall": _NO_STALL_RAD,
        "CL0": 0.0, "CLa": 0.0, "CD0": 0.0,
    }  # fmt: skip
    for factor, ending in (("beta", "b"), ("p", "p"), ("r", "r")):
        numbers |= dict(zip((f"CY{ending}", f"Cell{ending}", f"Cen{ending}"), c[factor], strict=True))
    servos = [f"{n}: {', '.join(s.lines())}" for n, s in side.servos.items() if s.lines()]
    notes = [
        f"{name}: side force, roll and yaw by the inflight advisor. Put the plugin into <model>.",
        "Link frame: x ahead, y left, z up, origin at the centre of mass. Rename link and joints.",
        f"The link needs {reference.mass_kg:.6g} kg, ixx {reference.ixx_kg_m2:.6g}, izz "
        f"{reference.izz_kg_m2:.6g}, ixz {reference.ixz_kg_m2 or 0.0:.6g} kg m2.",
        "A positive aileron joint rolls to the left, a positive rudder joint yaws to the left.",
        f"At {side.true_airspeed_m_s:.4g} m/s true. {air_note(side.air)}",
        f"Before the joints' commands, and no part of the plugin: {'; '.join(servos) or 'none'}.",
    ]
    inside = "".join(f" <{key}>{value:.8g}</{key}>\n" for key, value in numbers.items())
    inside += f" <num_ctrl_surfaces>{len(JOINTS)}</num_ctrl_surfaces>\n"
    inside += "".join(_surface(k, joint, c[factor]) for k, (factor, joint) in enumerate(JOINTS.items()))
    text = "".join(xml_comment(note) + "\n" for note in notes) + (
        '<plugin filename="gz-sim-advanced-lift-drag-system" name="gz::sim::systems::AdvancedLiftDrag">\n'
        f" <link_name>base_link</link_name>\n{inside}"
        " <cp>0 0 0</cp>\n <forward>1 0 0</forward>\n <upward>0 0 1</upward>\n</plugin>\n"
    )
    return Exported(text, (*servos, *side.left_out))


def _coefficients(factor: str, side: SideModel, reference: Reference) -> Triple:
    """Return the coefficients by β or a rate, per radian, or by a joint, per degree."""
    speed, span = side.true_airspeed_m_s, reference.span_m or math.nan
    force = side.air.dynamic_pressure(side.trim.airspeed_m_s) * (reference.wing_area_m2 or math.nan)
    unit = {"p": 2.0 * speed / span, "r": 2.0 * speed / span}.get(factor, 1.0)
    unit = math.radians(1.0) if factor in JOINTS else unit
    across, roll, yaw = (side.number(f"{letter}_{factor}") for letter in "YLN")
    ixx, izz = reference.ixx_kg_m2 or math.nan, reference.izz_kg_m2 or math.nan
    ixz = reference.ixz_kg_m2 or 0.0
    return (
        unit * (reference.mass_kg or math.nan) * speed * across / force,
        unit * (ixx * roll - ixz * yaw) / (force * span),
        unit * (izz * yaw - ixz * roll) / (force * span),
    )


def _surface(index: int, joint: str, c: Triple) -> str:
    numbers = {
        "index": index, "direction": 1, "CD_ctrl": 0.0, "CY_ctrl": c[0], "CL_ctrl": 0.0,
        "Cell_ctrl": c[1], "Cem_ctrl": 0.0, "Cen_ctrl": c[2],
    }  # fmt: skip
    inside = "".join(f"  <{key}>{value:.8g}</{key}>\n" for key, value in numbers.items())
    return f" <control_surface>\n  <name>{joint}</name>\n{inside} </control_surface>\n"
