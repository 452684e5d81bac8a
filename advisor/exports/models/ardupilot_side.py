"""Roll and yaw of ArduPilot's built-in plane, for ``--model plane:FILE.json``.

Its conventions, from its source (``libraries/SITL/SIM_Plane``), in addition to those of ``ardupilot``:

- the torque is the rotational acceleration, so that derivatives with the products of inertia inside fit as
  they are: c_l_b = L_β/(q̄·S·b), and rates are made dimensionless by b/(2·V);
- the side force is divided by 2 kg: c_y_b = Y_β·V·2 kg/(q̄·S);
- the sideslip is positive with wind from the right;
- aileron and rudder are numbers from -1 to 1, at 1000 and 2000 us of outputs 1 and 4: their coefficients are
  per full travel, with the sign of the calibration.
"""

import json
import math

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.exports.models.ardupilot import MASS_KG, line_of
from advisor.exports.models.exported import Exported, commented
from advisor.exports.models.flown import SideModel
from advisor.exports.models.improvement import require_reference
from advisor.flight.signals.standard_atmosphere import standard_density, standard_pressure

KEYS = {"beta": "b", "p": "p", "r": "r", "delta_a": "deltaa", "delta_r": "deltar"}
"""Factor of a derivative to the spelling of ArduPilot's keys."""
_CONTROLS = {"delta_a": "aileron", "delta_r": "rudder"}


def side_model_text(name: str, side: SideModel, aircraft: Aircraft) -> Exported:
    """Return the plane's coefficients of side force, roll and yaw as JSON with comments.

    Raises
    ------
    ConfigurationError
        The wing's area or span, or a calibration, is missing.
    """
    require_reference(aircraft.reference, ("wing_area_m2", "span_m"))
    area, span = aircraft.reference.wing_area_m2 or math.nan, aircraft.reference.span_m or math.nan
    speed, estimate = side.trim.airspeed_m_s, side.found.estimate
    density = float(standard_density(standard_pressure(side.height_m)))
    pressure = 0.5 * density * speed**2
    moment = 1.0 / (pressure * area * span)
    scale = {"Y": MASS_KG * speed / (pressure * area), "L": moment, "N": moment}
    rate = 2.0 * speed / span
    travel = {
        factor: line_of([(1.0, pairs)] if (pairs := getattr(aircraft, control).calibration) else [], control)[
            1
        ]
        for factor, control in _CONTROLS.items()
    }
    factors = {"beta": 1.0, "p": rate, "r": rate, **travel}
    keys: dict[str, float | list[float]] = {"s": area, "b": span}
    for parameter in SIDE_PARAMETERS:
        if parameter not in estimate.not_identifiable:
            letter, factor = parameter[0], parameter[2:]
            value = scale[letter] * factors[factor] * estimate.value(parameter)
            keys[f"c_{letter.lower()}_{KEYS[factor]}"] = float(f"{value:.6g}")
    keys["CGOffset"] = [0.0, 0.0, 0.0]
    head = [
        f"{name}: roll and yaw by `advisor analyze`, at {speed:.4g} m/s. Load: --model plane:THIS-FILE",
        "Merge into your own file: without lift, drag and pitch keys ArduPilot keeps its small plane's.",
        "c_l_* and c_n_* hold the moments of inertia: ArduPilot takes the torque as acceleration.",
        "c_y_* are for 2 kg, the mass of ArduPilot's plane.",
        "c_*_deltaa and c_*_deltar are per 500 us of pulse width, "
        f"{math.degrees(travel['delta_a']):+.4g} and {math.degrees(travel['delta_r']):+.4g} deg here.",
        f"Air density {density:.4f} kg/m3.",
    ]
    left = tuple(f"{p}: {reason}" for p, reason in estimate.not_identifiable.items())
    return Exported(commented(head, "#") + json.dumps(keys, indent=1) + "\n", left)
