"""Everything the equations of motion need to know about an aircraft and its departures."""

from typing import NamedTuple

from .aircraft import Aircraft

OUT_OF_REACH = 10.0  # rad, for thresholds that no flight crosses


class FlightModel(NamedTuple):
    """Mass, geometry, coefficients and departures [SI, per rad]."""

    mass: float
    pitch_inertia: float
    wing_area: float
    chord: float
    span: float
    elevation: float
    cl_0: float
    cl_alpha: float
    cl_q: float
    cl_delta_e: float
    cd_0: float
    induced_drag: float
    cm_0: float
    cm_alpha: float
    cm_q: float
    cm_delta_e: float
    # The trim about which nonlinear terms are written.
    airspeed: float
    alpha: float = 0.0
    elevator: float = 0.0
    thrust: float = 0.0
    # Lift: a polynomial, Kirchhoff's trailing-edge separation, or a table with two breaks.
    cl_alpha_2: float = 0.0
    cl_alpha_3: float = 0.0
    separation_alpha: float = OUT_OF_REACH
    separation_sharpness: float = 10.0
    table_break: float = OUT_OF_REACH
    table_slope_above: float = 0.0
    table_slope_below: float = 0.0
    # Lift that follows late: alpha_e = alpha - share (alpha - x), x' = (alpha - x) / time.
    lag_share: float = 0.0
    lag_time: float = 1.0
    # Pitching moment.
    cm_alpha_2: float = 0.0
    cm_alpha_3: float = 0.0
    pitch_up_break: float = OUT_OF_REACH
    pitch_up_slope: float = 0.0
    cm_delta_2: float = 0.0
    cm_delta_3: float = 0.0
    cm_alpha_dot: float = 0.0
    thrust_arm: float = 0.0
    speed_exponent: float = 0.0
    ground_lift: float = 0.0
    ground_moment: float = 0.0
    # Fuselage bending as the rate gyro sees it.
    mode_frequency: float = 30.0
    mode_damping: float = 0.05
    mode_from_elevator: float = 1.0
    # Departures that no named effect describes.
    damping_asymmetry: float = 0.0
    tail_stall_angle: float = OUT_OF_REACH
    tail_stall_loss: float = 0.0
    tail_arm: float = 0.0
    slipstream: float = 0.0
    slosh_gain: float = 0.0
    slosh_frequency: float = 5.0
    slosh_damping: float = 0.05
    blowback_lift: float = 0.0
    hysteresis_lift: float = 0.0
    hysteresis_on: float = OUT_OF_REACH
    hysteresis_off: float = OUT_OF_REACH
    buffet_lift: float = 0.0
    buffet_alpha: float = OUT_OF_REACH
    buffet_frequency: float = 15.0


def plain_model(aircraft: Aircraft) -> FlightModel:
    """The aircraft without any departure."""
    return FlightModel(
        mass=aircraft.mass_kg,
        pitch_inertia=aircraft.pitch_inertia_kg_m2,
        wing_area=aircraft.wing_area_m2,
        chord=aircraft.chord_m,
        span=aircraft.span_m,
        elevation=aircraft.elevation_m,
        cl_0=aircraft.cl_0,
        cl_alpha=aircraft.cl_alpha,
        cl_q=aircraft.cl_q,
        cl_delta_e=aircraft.cl_delta_e,
        cd_0=aircraft.cd_0,
        induced_drag=aircraft.induced_drag,
        cm_0=aircraft.cm_0,
        cm_alpha=aircraft.cm_alpha,
        cm_q=aircraft.cm_q,
        cm_delta_e=aircraft.cm_delta_e,
        airspeed=aircraft.airspeed_m_s,
    )
