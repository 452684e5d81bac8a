"""Kinds of gap outside the catalogue that change the motion: verdict `unknown`, in the block given here."""

from dataclasses import replace

import numpy as np

from .atmosphere import mountain_wave, thermal, wake_crossing
from .effects import Effect, Experiment, Outcome, sign

Generator = np.random.Generator


# The elevator's way from the command to the surface.


def cable_stretch(case: Experiment, size: float, rng: Generator) -> Outcome:
    stretch, preload = min(0.4 * size, 0.9), 0.35 * case.plan.typical_elevator
    changed = case.with_servo(cable_stretch=stretch, cable_preload=preload)
    return changed, {"stretch": stretch, "preload_rad": preload}


def elevator_stiction(case: Experiment, size: float, rng: Generator) -> Outcome:
    threshold = 0.3 * size * case.plan.typical_elevator
    return case.with_servo(stiction=threshold), {"threshold_rad": threshold}


def servo_limit_cycle(case: Experiment, size: float, rng: Generator) -> Outcome:
    amplitude, omega = 0.25 * size * case.plan.typical_elevator, case.omega * float(rng.uniform(1.2, 2.5))
    changed = case.with_servo(oscillation=amplitude, oscillation_frequency=omega)
    return changed, {"amplitude_rad": amplitude, "frequency_rad_s": omega}


def command_dropouts(case: Experiment, size: float, rng: Generator) -> Outcome:
    lost = np.zeros(len(case.time))
    duration = float(np.clip(0.5 * size / case.omega, 0.06, 0.8))
    for maneuver in case.plan.maneuvers:
        for start in rng.uniform(maneuver.start, maneuver.start + 7.0 * maneuver.unit, 2):
            lost[(case.time >= start) & (case.time < start + duration)] = 1.0
    return replace(case, dropout=lost), {"duration_s": duration}


def coarse_servo(case: Experiment, size: float, rng: Generator) -> Outcome:
    resolution = 0.6 * size * case.plan.typical_elevator
    return case.with_servo(resolution=resolution), {"resolution_rad": resolution}


def servo_stall(case: Experiment, size: float, rng: Generator) -> Outcome:
    limit = case.plan.typical_elevator * max(0.85 - 0.25 * size, 0.15)
    return case.with_servo(torque_limit=limit), {"torque_limit_rad": limit}


def elevator_float(case: Experiment, size: float, rng: Generator) -> Outcome:
    share = min(0.45 * size, 1.2)
    return case.with_servo(float_per_alpha=share), {"elevator_per_alpha": share}


# Moments and forces.


def fuel_slosh(case: Experiment, size: float, rng: Generator) -> Outcome:
    omega = case.omega * float(rng.uniform(0.5, 1.1))
    gain = 0.10 * size * case.omega**2
    changed = case.with_model(slosh_gain=gain, slosh_frequency=omega, slosh_damping=0.04)
    return changed, {"gain_rad_s2": gain, "frequency_rad_s": omega}


def tail_stall(case: Experiment, size: float, rng: Generator) -> Outcome:
    angle, loss = 0.5 * case.plan.typical_elevator, min(0.7 * size, 1.4)
    changed = case.with_model(tail_stall_angle=angle, tail_stall_loss=loss, tail_arm=3.0)
    return changed, {"angle_rad": angle, "loss": loss}


def asymmetric_damping(case: Experiment, size: float, rng: Generator) -> Outcome:
    value = sign(rng) * min(0.45 * size, 0.95) * case.model.cm_q
    return case.with_model(damping_asymmetry=value), {"cm_q_difference": value}


def engine_cooling(case: Experiment, size: float, rng: Generator) -> Outcome:
    # A moment that comes with each manoeuvre's change of power setting, and dies away as metal cools.
    moment = np.zeros(len(case.time))
    jump = sign(rng) * 0.25 * size * abs(case.model.cm_delta_e) * case.plan.typical_elevator
    lag = float(rng.uniform(1.0, 4.0))
    for maneuver in case.plan.maneuvers:
        begin = maneuver.start + rng.uniform(0.0, 0.3) * (maneuver.end - maneuver.start)
        moment += jump * np.exp(-np.maximum(case.time - begin, 0.0) / lag) * (case.time >= begin)
    return replace(case, moment_added=moment), {"cm": jump, "decay_s": lag}


def slipstream_change(case: Experiment, size: float, rng: Generator) -> Outcome:
    return case.with_model(slipstream=0.5 * size), {"effectiveness_per_power": 0.5 * size}


def flap_blowback(case: Experiment, size: float, rng: Generator) -> Outcome:
    return case.with_model(blowback_lift=0.35 * size), {"cl_per_pressure": 0.35 * size}


def lift_hysteresis(case: Experiment, size: float, rng: Generator) -> Outcome:
    on, off, lost = float(rng.uniform(0.012, 0.02)), float(rng.uniform(-0.01, 0.0)), 0.08 * size
    alpha = case.model.alpha
    changed = case.with_model(hysteresis_lift=lost, hysteresis_on=alpha + on, hysteresis_off=alpha + off)
    return changed, {"cl_lost": lost, "on_rad": on, "off_rad": off}


def stall_buffet(case: Experiment, size: float, rng: Generator) -> Outcome:
    omega, corner, lift = case.omega * float(rng.uniform(2.0, 4.0)), 0.01, 0.08 * size
    changed = case.with_model(
        buffet_lift=lift, buffet_alpha=case.model.alpha + corner, buffet_frequency=omega
    )
    return changed, {"cl": lift, "frequency_rad_s": omega}


# Air.


def mountain_waves(case: Experiment, size: float, rng: Generator) -> Outcome:
    period = float(rng.uniform(10.0, 20.0)) / case.omega
    peak = 0.02 * size * case.aircraft.airspeed_m_s
    changed = case.with_upward(mountain_wave(case.time, period, peak, rng.uniform(0.0, 6.28)))
    return changed, {"peak_m_s": peak, "period_s": period}


def thermals(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak = 0.035 * size * case.aircraft.airspeed_m_s
    upward = np.zeros(len(case.time))
    for maneuver in case.plan.maneuvers:
        centre, width = rng.uniform(maneuver.start, maneuver.end), rng.uniform(2.0, 5.0) / case.omega
        upward += thermal(case.time, centre, width, peak * rng.uniform(0.6, 1.4))
    return case.with_upward(upward), {"peak_m_s": peak}


def wake_crossings(case: Experiment, size: float, rng: Generator) -> Outcome:
    peak = 0.05 * size * case.aircraft.airspeed_m_s
    upward = np.zeros(len(case.time))
    for maneuver in case.plan.maneuvers:
        centre, core = rng.uniform(maneuver.start, maneuver.end), rng.uniform(0.3, 0.7) / case.omega
        upward += wake_crossing(case.time, centre, core, peak)
    return case.with_upward(upward), {"peak_m_s": peak}


OUTSIDE_IN_MOTION = (
    Effect("cable_stretch", "input", cable_stretch),
    Effect("elevator_stiction", "input", elevator_stiction),
    Effect("servo_limit_cycle", "input", servo_limit_cycle),
    Effect("command_dropouts", "input", command_dropouts),
    Effect("coarse_servo", "input", coarse_servo),
    Effect("servo_stall", "input", servo_stall),
    Effect("elevator_float", "input", elevator_float),
    Effect("fuel_slosh", "moment_equation", fuel_slosh),
    Effect("tail_stall", "moment_equation", tail_stall),
    Effect("asymmetric_damping", "moment_equation", asymmetric_damping),
    Effect("engine_cooling", "moment_equation", engine_cooling),
    Effect("slipstream_change", "moment_equation", slipstream_change, needs="power"),
    Effect("flap_blowback", "force_equation", flap_blowback, needs="speed"),
    Effect("lift_hysteresis", "force_equation", lift_hysteresis),
    Effect("stall_buffet", "force_equation", stall_buffet),
    Effect("mountain_waves", "air", mountain_waves),
    Effect("thermals", "air", thermals),
    Effect("wake_crossings", "air", wake_crossings),
)
