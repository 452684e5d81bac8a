"""Effects of the contract in the elevator's way, the equations of motion and the air."""

from dataclasses import replace

import numpy as np

from .atmosphere import dryden, one_minus_cosine
from .effects import Effect, Experiment, Outcome, appearing, sign

Generator = np.random.Generator


def actuator_lag(case: Experiment, size: float, rng: Generator) -> Outcome:
    lag = size * 0.30 / case.omega
    kind = str(rng.choice(["first order", "second order", "second order, rate limited"]))
    if kind == "first order":
        return case.with_servo(lag=lag), {"lag_s": lag, "kind": kind}
    damping = float(rng.uniform(0.6, 0.9))
    omega = 2.0 * damping / lag
    limit = 2.5 * case.plan.typical_elevator / lag if kind.endswith("limited") else case.servo.rate_limit
    changed = case.with_servo(natural_frequency=omega, damping=damping, rate_limit=limit)
    return changed, {"lag_s": lag, "kind": kind, "natural_frequency_rad_s": omega, "damping": damping}


def actuator_rate_limit(case: Experiment, size: float, rng: Generator) -> Outcome:
    rate = case.plan.typical_elevator * case.omega / (0.8 * size)
    return case.with_servo(rate_limit=rate), {"rate_rad_s": rate}


def actuator_backlash(case: Experiment, size: float, rng: Generator) -> Outcome:
    half = 0.22 * size * case.plan.typical_elevator
    return case.with_servo(half_play=half), {"half_width_rad": half}


def actuator_deadband(case: Experiment, size: float, rng: Generator) -> Outcome:
    half = 0.20 * size * case.plan.typical_elevator
    return case.with_servo(half_deadband=half), {"half_width_rad": half}


def transport_delay(case: Experiment, size: float, rng: Generator) -> Outcome:
    # A shorter delay is that of telemetry.
    delay = max(size * 0.28 / case.omega, 0.03)
    jitter = float(rng.uniform(0.0, 0.003))
    # The delay of a packet lasts until the next one.
    packets = rng.uniform(-jitter, jitter, len(case.time) // 10 + 1)
    varying = np.repeat(packets, 10)[: len(case.time)]
    return replace(case, delay=np.maximum(delay + varying, 0.0)), {"delay_s": delay, "jitter_s": jitter}


def elevator_nonlinearity(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak = case.plan.largest_elevator
    loss = min(0.3 * size, 0.55)
    slope = case.model.cm_delta_e
    if rng.random() < 0.5:
        return case.with_model(cm_delta_3=-loss * slope / peak**2), {"cubic_loss_at_peak": loss}
    # The loss goes with the square of the deflection on one side, and turns into a gain on the other.
    side = sign(rng)
    return case.with_model(cm_delta_2=side * loss * slope / peak), {"quadratic_at_peak": side * loss}


def nonlinear_pitching_moment(case: Experiment, size: float, rng: Generator) -> Outcome:
    scale = abs(case.model.cm_alpha) + 0.25
    kind = str(rng.choice(["quadratic", "cubic", "pitch-up"]))
    if kind == "quadratic":
        value = sign(rng) * 4.0 * size * scale
        return case.with_model(cm_alpha_2=value), {"kind": kind, "cm_alpha_2": value}
    if kind == "cubic":
        value = -70.0 * size * scale
        return case.with_model(cm_alpha_3=value), {"kind": kind, "cm_alpha_3": value}
    value, corner = 0.45 * size * scale, float(rng.uniform(0.005, 0.015))
    value = min(value, 0.9 * scale)
    changed = case.with_model(pitch_up_break=corner, pitch_up_slope=value)
    return changed, {"kind": kind, "slope": value, "break_rad": corner}


def thrust_moment(case: Experiment, size: float, rng: Generator) -> Outcome:
    arm = sign(rng) * 0.30 * size * case.aircraft.chord_m
    return case.with_model(thrust_arm=arm), {"thrust_arm_m": arm}


def cg_shift(case: Experiment, size: float, rng: Generator) -> Outcome:
    way = sign(rng) * 0.045 * size * case.aircraft.chord_m
    return replace(case, cg_aft=way * appearing(case.time, rng)), {"aft_m": way}


def alpha_dot(case: Experiment, size: float, rng: Generator) -> Outcome:
    value = 0.55 * size * case.model.cm_q
    return case.with_model(cm_alpha_dot=value), {"cm_alpha_dot": value}


def nonlinear_lift(case: Experiment, size: float, rng: Generator) -> Outcome:
    kind = str(rng.choice(["kirchhoff", "polynomial", "table"]))
    model = case.model
    if kind == "kirchhoff":
        beyond, sharpness = 0.05 / size, 25.0
        changed = case.with_model(separation_alpha=model.alpha + beyond, separation_sharpness=sharpness)
        return changed, {"kind": kind, "separation_beyond_trim_rad": beyond, "sharpness": sharpness}
    if kind == "polynomial":
        square, cube = -3.5 * size * model.cl_alpha, -25.0 * size * model.cl_alpha
        return case.with_model(cl_alpha_2=square, cl_alpha_3=cube), {"kind": kind, "cl_alpha_2": square}
    corner, loss = float(rng.uniform(0.008, 0.018)), min(0.35 * size, 0.85) * model.cl_alpha
    share = float(rng.uniform(0.0, 0.4))
    changed = case.with_model(table_break=corner, table_slope_above=-loss, table_slope_below=-share * loss)
    return changed, {"kind": kind, "break_rad": corner, "slope_lost_above": loss}


def unsteady_lift(case: Experiment, size: float, rng: Generator) -> Outcome:
    share = min(0.28 * size, 0.75)
    lag = float(rng.uniform(0.5, 1.0)) / case.omega
    return case.with_model(lag_share=share, lag_time=lag), {"share": share, "lift_lag_s": lag}


def mass_change(case: Experiment, size: float, rng: Generator) -> Outcome:
    # Dropped load or burnt fuel, seldom taken on board.
    change = 0.16 * size if rng.random() < 0.3 else -min(0.14 * size, 0.4)
    return replace(case, mass_added=change * appearing(case.time, rng)), {"mass_added": change}


def icing(case: Experiment, size: float, rng: Generator) -> Outcome:
    lost = min(0.13 * size, 0.4)
    return replace(case, ice=lost * appearing(case.time, rng)), {"lift_slope_lost": lost}


def airspeed_variation(case: Experiment, size: float, rng: Generator) -> Outcome:
    exponent = sign(rng) * 0.9 * size
    return case.with_model(speed_exponent=exponent), {"exponent_beyond_dynamic_pressure": exponent}


def ground_effect(case: Experiment, size: float, rng: Generator) -> Outcome:
    lift = 0.12 * size
    moment = 0.03 * size
    return case.with_model(ground_lift=lift, ground_moment=moment), {
        "ground_lift": lift,
        "ground_moment": moment,
    }


def turbulence(case: Experiment, size: float, rng: Generator) -> Outcome:
    speed = case.aircraft.airspeed_m_s
    rms = 0.016 * size * speed
    along = float(rng.uniform(0.7, 1.2)) * rms
    scale = float(rng.uniform(1.5, 4.0)) * speed
    span = case.aircraft.span_m
    extra = dryden(rng, len(case.time), case.plan.step, speed, (rms, along), scale, span)
    return replace(case, air=case.air.plus(extra)), {
        "rms_m_s": rms,
        "along_rms_m_s": along,
        "length_m": scale,
    }


def gust(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak = 0.035 * size * case.aircraft.airspeed_m_s
    upward = np.zeros(len(case.time))
    maneuvers = case.plan.maneuvers
    for k in rng.permutation(len(maneuvers))[: int(rng.integers(3, len(maneuvers)))]:
        start = rng.uniform(maneuvers[k].start, 0.4 * maneuvers[k].start + 0.6 * maneuvers[k].end)
        upward += one_minus_cosine(case.time, start, rng.uniform(3.0, 7.0) / case.omega, sign(rng) * peak)
    return case.with_upward(upward), {"peak_m_s": peak}


NAMED_IN_MOTION = (
    Effect("actuator_lag", "input", actuator_lag),
    Effect("actuator_rate_limit", "input", actuator_rate_limit),
    Effect("actuator_backlash", "input", actuator_backlash),
    Effect("actuator_deadband", "input", actuator_deadband),
    Effect("transport_delay", "input", transport_delay),
    Effect("elevator_nonlinearity", "moment_equation", elevator_nonlinearity),
    Effect("nonlinear_pitching_moment", "moment_equation", nonlinear_pitching_moment),
    Effect("thrust_moment", "moment_equation", thrust_moment, needs="power"),
    Effect("cg_shift", "moment_equation", cg_shift),
    Effect("alpha_dot", "moment_equation", alpha_dot),
    Effect("nonlinear_lift", "force_equation", nonlinear_lift),
    Effect("unsteady_lift", "force_equation", unsteady_lift),
    Effect("mass_change", "force_equation", mass_change),
    Effect("icing", "force_equation", icing),
    Effect("airspeed_variation", "force_equation", airspeed_variation, needs="speed"),
    Effect("ground_effect", "force_equation", ground_effect, needs="low"),
    Effect("turbulence", "air", turbulence),
    Effect("gust", "air", gust),
)
