"""Format ``sdf``: Gazebo plugins for lift, drag and side force.

Pitch has two ``gz::sim::systems::LiftDrag`` plugins, a wing and a tail.
A LiftDrag surface has lift C = cla·(a0 + α) + control_joint_rad_to_cl·δ at its centre of pressure. The
rotation of the aircraft changes the air flow at that point. A surface has no damping of its own, and Gazebo's
source resets the moment of ``cma`` to zero. Two surfaces of wing area S do not need damping and ``cma``. The
wing (w) lies at the centre of gravity, and the tail (t) at the distance x ahead of it (x is negative).

    C_Lα = a_w + a_t        C_mα = a_t·x/c        C_mq = -2·a_t·x²/c²        C_mδe = e·x/c

The plugin values are x = -c·C_mq/(2·C_mα), a_t = C_mα·c/x, a_w = C_Lα - a_t and e = C_mδe·c/x. The zero-lift
angles follow from C_L0 = a_w·a0_w + a_t·a0_t and C_m0 = a_t·a0_t·x/c. The resulting C_Lδe = e and C_Lq =
-2·C_mα may differ from the estimates.

Roll and yaw have one ``gz::sim::systems::AdvancedLiftDrag`` plugin without lift and pitching moment.
Its conventions, from its source (``src/systems/advanced_lift_drag``):

- coefficients of β and of the rates p·b/(2·V), r·b/(2·V) are per radian, those of a joint per degree;
- roll is positive right wing down, yaw positive nose right, and β positive with wind from the right;
- torques act on the link's inertia, so the products of inertia are taken out of L and N:
  l = I_xx·L − I_xz·N and n = I_zz·N − I_xz·L;
- the plugin sets the pitching moment of α to zero (it assigns ``Cemb``·β), so that pitch stays with the wing
  and the tail.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import Reference
from advisor.exports.models.exported import Exported, effects_beside, xml_comment
from advisor.exports.models.flown import FlownModel, SideModel
from advisor.exports.models.formats import AxisAsked, ModelFormat, refuse_lacking
from advisor.exports.models.improvement import REFERENCE_KEYS, Improvement, air_note, missing_reference
from advisor.words.problems import ConfigurationError


class SdfFormat(ModelFormat):
    """Gazebo plugins for a ``<model>`` element."""

    suffix = ".sdf"

    def refuse(self, file: Path, aircraft: Aircraft, axis: AxisAsked) -> None:
        """Refuse missing keys of the axis."""
        missing = lacking(aircraft.reference)
        refuse_lacking([missing[axis]] if axis != "both" else [*missing.values()], "sdf")

    def made(self, model: FlownModel, file: Path) -> Exported:
        """Return the plugins."""
        return plugins_text(model)


FORMAT = SdfFormat()


def plugins_text(model: FlownModel) -> Exported:
    """Return the plugins of all known axes, for a ``<model>`` element.

    Raises
    ------
    ConfigurationError
        Reference data are missing for every known axis, or no tail gives these derivatives.
    """
    reference = model.aircraft.reference
    missing = lacking(reference)
    made, left = [], []
    if model.pitch is not None and not missing["pitch"]:
        made.append(block_text(model.pitch))
    else:
        left.append(_why_not("pitch", model.pitch is not None, missing["pitch"]))
    if model.side is not None and not missing["lateral"]:
        made.append(side_block_text(model.name, reference, model.side))
    else:
        left.append(_why_not("roll and yaw", model.side is not None, missing["lateral"]))
    if not made:
        raise ConfigurationError(f"--export sdf: nothing can be written: {'; '.join(left)}.")
    left += [x for part in made for x in part.left_out]
    return Exported("".join(part.text for part in made), tuple(left))


def _why_not(axis: str, is_known: bool, missing: Sequence[str]) -> str:
    return f"{axis}, " + (
        f"for want of reference {', '.join(missing)}" if is_known else "which no flight and no file gives"
    )


def lacking(reference: Reference) -> Mapping[str, tuple[str, ...]]:
    """Return the keys of ``reference`` that each axis' plugins lack."""
    return {
        "pitch": missing_reference(reference, REFERENCE_KEYS),
        "lateral": missing_reference(reference, SIDE_KEYS),
    }


def block_text(improvement: Improvement) -> Exported:
    """Return the two plugins of pitch.

    Raises
    ------
    ConfigurationError
        Reference data are missing, or no tail behind the centre of gravity gives these derivatives.
    """
    c = {name: coefficient.value for name, coefficient in improvement.coefficients().items()}
    reference = improvement.reference
    chord, area = reference.chord_m or 0.0, reference.wing_area_m2 or 0.0
    if not (c["C_m_alpha"] < 0.0 and c["C_m_q"] < 0.0):
        raise ConfigurationError(
            "--export sdf: a wing and a tail need M_alpha and M_q below zero, and here one is not; "
            "use --export matlab or ardupilot."
        )
    behind = -0.5 * chord * c["C_m_q"] / c["C_m_alpha"]
    tail = c["C_m_alpha"] * chord / behind
    wing = c["C_L_alpha"] - tail
    if wing <= 0.0:
        raise ConfigurationError(
            "--export sdf: the tail that gives C_m_alpha and C_m_q would lift more than the whole aircraft; "
            "use --export matlab or ardupilot."
        )
    control = c["C_m_delta_e"] * chord / behind
    tail_zero = c["C_m_0"] / c["C_m_alpha"]
    wing_zero = (c["C_L_0"] - tail * tail_zero) / wing
    servo = ", ".join(improvement.servo.lines()) or "none"
    notes = [
        f"{improvement.name}: lift and pitching moment found by advisor gap. Put both plugins into <model>.",
        "Link frame: x ahead, y left, z up; cp is relative to the centre of mass. Rename link and joint.",
        f"The link needs {reference.mass_kg:.6g} kg and iyy {reference.iyy_kg_m2:.6g} kg m2.",
        "The joint is positive where the trailing edge is down.",
        f"{air_note(improvement.air)} Drag is not found by the diagnosis: add your drag coefficient as cda.",
        "C_L and C_m per radian: " + ", ".join(f"{name} {value:.6g}" for name, value in c.items()) + ".",
        f"Kept: C_L_alpha, C_m_alpha, C_m_q, C_m_delta_e. Implied: C_L_delta_e {control:.6g}, "
        f"C_L_q {-2.0 * c['C_m_alpha']:.6g}.",
        f"Before the joint's command, and no part of LiftDrag: {servo}.",
    ]
    text = "".join(xml_comment(note) + "\n" for note in notes)
    common = {"area": area, "air_density": improvement.air.density_kg_m3}
    joint = {"control_joint_name": "elevator_joint", "control_joint_rad_to_cl": f"{control:.8g}"}
    text += _plugin({"a0": wing_zero, "cla": wing, **common}, 0.0, {})
    text += _plugin({"a0": tail_zero, "cla": tail, **common}, behind, joint)
    return Exported(text, (*improvement.servo.lines(), *effects_beside(improvement), *improvement.untold))


def _plugin(numbers: dict[str, float], ahead_m: float, joint: dict[str, str]) -> str:
    """Return the plugin of one surface, with its control joint."""
    texts = {name: f"{value:.8g}" for name, value in numbers.items()} | joint
    inside = "".join(f" <{name}>{text}</{name}>\n" for name, text in texts.items())
    return (
        '<plugin filename="gz-sim-lift-drag-system" name="gz::sim::systems::LiftDrag">\n'
        f" <link_name>base_link</link_name>\n{inside}"
        f" <cp>{ahead_m:.8g} 0 0</cp>\n <forward>1 0 0</forward>\n <upward>0 0 1</upward>\n</plugin>\n"
    )


SIDE_KEYS = ("mass_kg", "wing_area_m2", "span_m", "ixx_kg_m2", "izz_kg_m2")
JOINTS = {"delta_a": "aileron_joint", "delta_r": "rudder_joint"}
_NO_STALL_RAD = 1.5
"""Angle of attack above which the plugin adds a flat plate's lift, rad, beyond all flight."""
_ANY_EFFICIENCY = 0.9
"""Factor of the induced drag, which is zero without lift. The plugin divides by the factor."""

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
