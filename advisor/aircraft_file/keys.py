"""The keys of an aircraft file that a crew fills in: meaning, question, and cost of the missing key."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Key:
    """One key of the aircraft file."""

    path: str
    """Section and name, e.g. ``elevator.lag_s``."""
    meaning: str
    """Quantity, unit and sign, for the comment in the file."""
    example: str
    """Value in YAML for the comment, while the true value is unknown."""
    question: str = ""
    """Question on the terminal. Empty: never asked."""
    cost: str = ""
    """Sentence on the cost of the missing key. Empty: a missing key costs nothing."""
    mend: str = ""
    """Clause on how a crew finds the value."""


KEYS = (
    Key("name", "on screens and reports", "my aircraft", "Name of the aircraft"),
    Key(
        "elevator.output",
        "servo output 1..32, or auto: by the autopilot's parameters in the log or link",
        "auto",
        "Servo output of the elevator: a number, several (1 2), or auto",
        "The elevator is found by the autopilot's parameters; a log or link without them is refused.",
        "write the number of the servo output",
    ),
    Key(
        "elevator.calibration",
        "[[PWM in us, deflection in deg], ...], trailing edge down positive",
        "[[1100, -25.0], [1500, 0.0], [1900, 25.0]]",
        "Measured deflections of output {}, PWM:deg, trailing edge down positive (1100:-25 1500:0 1900:25)",
        "The servo's end points count as 25 deg, so Z_delta_e and M_delta_e have an assumed scale.",
        "measure the deflection at three pulse widths",
    ),
    Key(
        "elevator.lag_s",
        "first-order lag of the servo, s",
        "0.05",
        "First-order lag of the elevator's servo, s",
        "The lag is estimated with the derivatives: wider intervals, and M_alpha and M_delta_e too small "
        "where a flight does not determine it.",
        "film a step of the servo on the ground; the lag is the time to 63 % of the step",
    ),
    Key(
        "elevator.delay_s",
        "delay between the logged command and the servo's first movement, s",
        "0.02",
        "Delay from the logged command to the servo's first movement, s",
        "The delay counts as zero; a real delay biases M_alpha and M_q.",
        "film a step of the servo on the ground; the delay ends when the arm begins to move",
    ),
    Key(
        "alpha.source",
        "auto, aoa_ssa, derived, none, or named_value:NAME for a vane that sends NAMED_VALUE_FLOAT",
        "auto",
        "Angle of attack from: auto, aoa_ssa, derived, none, or named_value:NAME",
    ),
    Key(
        "alpha.vane_arm_m",
        "distance of the vane ahead of the centre of gravity, m; 0: corrected already",
        "0.0",
        "Distance of the vane ahead of the centre of gravity, m",
        "The place of the vane is estimated with the derivatives: wider intervals of Z_alpha and Z_q.",
        "measure the distance along the fuselage",
    ),
    Key(
        "accelerometer.arm_m",
        "distance of the autopilot ahead of the centre of gravity, m",
        "0.0",
        "Distance of the autopilot ahead of the centre of gravity, m",
        "The accelerometer counts as at the centre of gravity, unless alpha.vane_arm_m is given: then its "
        "place is estimated.",
        "measure the distance along the fuselage",
    ),
    Key(
        "airspeed_m_s",
        "true air speed, m/s; only for logs without one",
        "20.0",
        "",
        "This log has no air speed: the specific force cannot be used, and without an angle of attack "
        "nothing can.",
        "write the true air speed that was flown",
    ),
    Key(
        "reference_airspeed_m_s",
        "air speed at which the derivatives are given, m/s",
        "20.0",
        "Air speed at which derivatives are given, m/s",
        "The derivatives hold at the mean air speed of each flight, so two flights are not compared at one.",
        "write the air speed of the test point",
    ),
    Key(
        "reference.mass_kg",
        "mass, kg",
        "10.0",
        "Mass, kg",
        "No non-dimensional lift derivatives, and no static margin.",
        "weigh the aircraft",
    ),
    Key(
        "reference.wing_area_m2",
        "wing area, m²",
        "0.6",
        "Wing area, m²",
        "No non-dimensional derivatives (C_m_alpha and the like).",
        "take the area from the drawing",
    ),
    Key(
        "reference.chord_m",
        "mean aerodynamic chord, m",
        "0.25",
        "Mean aerodynamic chord, m",
        "No non-dimensional derivatives, and no static margin.",
        "take the chord from the drawing",
    ),
    Key(
        "reference.iyy_kg_m2",
        "pitching moment of inertia about the centre of gravity, kg m²",
        "1.0",
        "Pitching moment of inertia, kg m²",
        "No non-dimensional moment derivatives, and no static margin.",
        "swing the aircraft as a pendulum, or take the value of the design",
    ),
    Key(
        "reference.cg_percent_chord",
        "centre of gravity behind the leading edge of the mean aerodynamic chord, percent of the chord",
        "25.0",
        "Centre of gravity behind the leading edge, percent of the chord",
        "The static margin is not turned into the place of the neutral point.",
        "balance the aircraft",
    ),
    Key(
        "model",
        "the simulator's derivatives, Z_0 to M_delta_e in rad and s",
        "{M_alpha: -48.0, M_q: -4.2, M_delta_e: -100.0, Z_alpha: -8.0}",
        "",
        "advisor gap has no simulator to compare the flight with, unless --simulator names one.",
        "write the simulator's derivatives, or give simulator",
    ),
    Key(
        "limits.bank_deg",
        "largest bank within a test manoeuvre, deg",
        "30.0",
        "Largest bank within a test manoeuvre, deg",
    ),
    Key(
        "limits.alpha_deg",
        "largest angle of attack within a test manoeuvre, deg",
        "12.0",
        "Largest angle of attack within a test manoeuvre, deg",
        "No advice and no verdict guards against the stall.",
        "write an angle a few degrees below the stall",
    ),
)
"""Keys in the order of the file."""

BY_PATH = {key.path: key for key in KEYS}
