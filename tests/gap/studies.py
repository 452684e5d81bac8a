"""The table of the gap's studies: what is flown, and what the diagnosis says of it."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.result import Diagnosis
from tests.gap.diagnosed import diagnose
from tests.gap.generator import LIGHT_AIRCRAFT, Airframe, Setup, fly
from tests.gap.studied_flights import (
    BANKS,
    MODEL,
    SERVO,
    arduplane,
    at_airspeed,
    cut_short,
    dead_band_about_each_trim,
    estimated,
    feeling,
    hard,
    jumping,
    lagging_more_and_more,
    later,
    logged_seldom,
    noisy_speed,
    put_into,
    read,
    reading,
    rubbed,
    saturating,
    simulated,
    six,
    stuck,
    through_filter,
    through_vane,
    wandering,
    weakened,
)

approx = pytest.approx


@dataclass(frozen=True)
class Study:
    """A fact: of this flight, by an aircraft with this file, the diagnosis says this."""

    fact: str
    flown: Setup | Callable[[], list[Maneuver]]
    verdict: str | None = None
    block: str | None = None
    named: list[str] | None = None
    """All causes that are present, the likeliest first."""
    first: str | None = None
    """The likeliest cause, where others may be present."""
    sizes: Mapping[str, Any] = field(default_factory=dict)
    """Numbers of the likeliest cause."""
    says: tuple[str, ...] = ()
    """In the sentence or in a note."""
    holds: Callable[[Diagnosis], Any] = lambda _: True
    """What else is true of the diagnosis."""
    file: Callable[[], Aircraft] = Aircraft

    def diagnosed(self) -> Diagnosis:
        return diagnose(fly(self.flown) if isinstance(self.flown, Setup) else self.flown(), self.file())


@cache
def number_file(maneuvers: int, noise: float, seed: int) -> Aircraft:
    """Return the aircraft file that a flight without a gap gives."""
    sound = diagnose(fly(Setup(maneuvers=maneuvers, noise=noise, seed=seed)), Aircraft())
    model = {name: number.value for name, number in sound.model.items()}
    return Aircraft(model=model, reference_airspeed_m_s=sound.reference_airspeed_m_s)


def right_file() -> Aircraft:
    return number_file(6, 0.005, 24)


def wrong_file(**factors: float) -> Callable[[], Aircraft]:
    """Return the right file with some numbers off by a factor."""
    return lambda: replace(
        right_file(), model=right_file().model | {n: f * right_file().model[n] for n, f in factors.items()}
    )


def believed(**changes: float) -> Callable[[], Aircraft]:
    """Return a file that nobody estimated, with some numbers stated otherwise."""
    return lambda: Aircraft(model={**MODEL, **changes})


def having(**effects: Mapping[str, float]) -> Callable[[], Aircraft]:
    return lambda: Aircraft(effects=effects)


def with_servo(**stated: Any) -> Callable[[], Aircraft]:
    return lambda: Aircraft(elevator=Elevator(**stated))


def shrinks_by(percent: float) -> Callable[[Diagnosis], bool]:
    return lambda d: d.shrink is not None and d.shrink.percent > percent


def off(d: Diagnosis, name: str, truth: float) -> float:
    """Return how far the likeliest cause's number is from the truth, in its own standard deviations."""
    number = d.causes[0].parameters[name]
    return abs(number.value - truth) / number.std


CLIPPED_LIFT = {"lets_go_at": 0.09, "holds_below": 0.05}
LATE_LIFT = {"lift_lag": 0.2, "lift_lag_share": 0.35}
BENDING = {"mode_gain": 0.6, "mode_hz": 4.0}
STICKING = {"breaks_at": 0.03, "drags": 0.005, "lag": 0.03}
RATE_LIMITED = (
    "aircraft: uav\nnoise: {{alpha_deg: {a}, pitch_rate_deg_s: {q}, pitch_deg: {a}, "
    "accelerometer_m_s2: {a}}}\n"
    "effects: {{actuator_rate_limit: {{rate_rad_s: {rate}}}}}\n"
)
C172 = """
aircraft: c172p
engine: jsbsim
airspeed_m_s: 50
noise: {alpha_deg: 0.05, pitch_rate_deg_s: 0.15, pitch_deg: 0.05, accelerometer_m_s2: 0.05}
maneuvers: ["3211", "rev", doublet, "rev", "3211", "rev"]
"""
LARGE = replace(LIGHT_AIRCRAFT, chord=3.0, mass=6000.0, iyy=25000.0, area=40.0, speed=70.0)
PULLED = Airframe(amplitude_deg=5.0)
EVERY = (0, 1, 2, 3, 4, 5)
QUIET = {"noise": 0.005}

# fmt: off
STUDIES = [
    # No cause.
    Study("nothing is there", six(coloured=0.8, seed=9, airframe=LIGHT_AIRCRAFT), "none", named=[]),
    Study("turns", Setup(maneuvers=5, banks_deg=BANKS), "none"),
    Study("turns without a yaw rate", lambda: [replace(m, channels={n: c for n, c in m.channels.items()
        if n != "r"}) for m in fly(Setup(maneuvers=5, banks_deg=BANKS))], "none"),
    Study("a tail in the propeller's wash, at any speed", six({"wash": 0.2}, speed_change=0.03, seed=31),
        "none"),
    Study("another engine's aircraft", simulated(C172), "untested", named=[]),
    Study("noise of the air speed", noisy_speed, "none", named=[], holds=lambda d: d.gap.before < 0.1),
    Study("noise that is quick", wandering("q", 0.06, 0.1), "none"),
    Study("noise that is everywhere", wandering("q", 0.03, 1.0, 0.02), "none"),
    Study("a throttle that moved once without a moment", six(thrust_amplitude=0.5, thrust_moves_in=(2,),
        seed=5), "none"),
    Study("a dead band below a tenth of a degree, in noise", six({"deadband": 0.0012}, noise=0.02, seed=71),
        named=[]),
    Study("an accelerometer's zero that is off by a common amount",
        reading(six(seed=5), "a_z", read(lambda y: y + 0.6)), "none"),
    Study("a command that is logged seldom", logged_seldom, "none"),
    Study("a gap that is too small for a name", Setup(switches={"extra_cm": 0.1, "extra_cm_lag": 0.25},
        noise=0.004, seed=3), "none", says=("too small to name a cause",),
        holds=lambda d: d.gap.before > 0.2),
    Study("one manoeuvre that the simulator flies alike", lambda: fly(Setup(maneuvers=3, seed=4))[:1], "none",
        file=believed()),
    Study("a file's speed where the log has one", six(seed=8), "none",
        file=lambda: Aircraft(airspeed_m_s=27.0), holds=lambda d: d.kinematics.finding == "consistent"
        and d.reference_airspeed_m_s == approx(22.0, rel=0.05)),
    Study("an autopilot's own angle of attack is late by nature", lambda: estimated(fly(six(seed=71))),
        "none", named=[], holds=lambda d: d.kinematics.finding == "late"),
    Study("ArduPlane's own angle of attack is late by nature", arduplane, named=[],
        file=lambda: Aircraft(elevator=SERVO), holds=lambda d: d.kinematics.finding == "late"),
    *(Study(f"a speed that follows a throttle {lag} s behind it", six(logs_throttle=True,
        heights_m=(80.0, 90.0, 85.0), seed=202, thrust_amplitude=0.8, engine_lag_s=lag), "none") for lag
        in (0.0, 0.6)),
    *(Study(f"an air speed that reads {share} of the true one", at_airspeed(share), verdict, holds=lambda d,
        share=share: float(next(n for n in d.notes
        if n.startswith("The motion shows a true air speed")).split()[8]) == approx(100.0 / share - 100.0,
        abs=0.7)) for share, verdict in ((0.95, "none"), (1.03, "none"), (0.86, "unknown"))),

    # Numbers of the file.
    Study("a number that is wrong", six(seed=4), "parameters", file=believed(M_alpha=-25.0),
        holds=lambda d: d.model["M_alpha"].value == approx(-37.4, rel=0.03)),
    Study("numbers that are right to a per cent", six(seed=4), "none",
        file=believed(M_alpha=1.02 * -37.0, M_delta_e=0.985 * -52.0),
        says=("its parameters are right to a few per cent",), holds=lambda d: d.gap.before > 0.1),
    Study("numbers that are off by a few per cent each", six(noise=0.02, seed=4), "parameters",
        file=believed(M_alpha=0.94 * -37.0, Z_alpha=1.07 * -4.3, M_delta_e=0.93 * -52.0, M_q=1.05 * -4.8),
        holds=lambda d: d.gap.before > 0.5),
    Study("a wrong number of the force", Setup(maneuvers=4, seed=5), "parameters", "force_equation",
        file=wrong_file(Z_alpha=0.75)),
    Study("a wrong number of the moment", Setup(maneuvers=4, seed=5), "parameters", "moment_equation",
        file=wrong_file(M_delta_e=0.75)),
    Study("three wrong numbers are no moment of the angle's rate", six(seed=28), "parameters",
        file=wrong_file(M_alpha=1.3, M_q=0.7, M_delta_e=1.2)),
    Study("a wrong number in moving air", six(gust_std=0.3, seed=29), "parameters",
        file=wrong_file(M_alpha=1.4)),
    Study("a wrong number beside an effect", six({"delay": 0.06}, seed=7), named=["transport_delay"],
        sizes={"delay_s": approx(0.06, abs=0.003)}, file=wrong_file(M_delta_e=0.75)),
    *(Study(f"a {name} of {value} in the file hides no delay", six({"delay": 0.06}, seed=3),
        first="transport_delay", sizes={"delay_s": approx(0.06, abs=0.004)}, file=believed(**{name: value}),
        holds=lambda d, name=name: d.model[name].value == approx(MODEL[name], rel=0.1)) for name, value
        in (("M_alpha", 37.0), ("M_delta_e", 52.0), ("M_delta_e", 0.0), ("M_delta_e", -0.9), ("M_q", 9.0),
        ("M_q", 40.0))),

    # Servo and command.
    Study("a slow servo, whose response has kinks", six({"rate_limit": 0.7}, seed=5),
        first="actuator_rate_limit", sizes={"rate_rad_s": approx(0.7, rel=0.1)}),
    *(Study(f"a servo at its limit, its command {how}", simulated(RATE_LIMITED.format(a=0.05, q=0.15,
        rate=0.7) + f'input: {how}\nmaneuvers: ["3211", "rev", doublet, "rev"]\n'),
        named=["actuator_rate_limit"], sizes={"rate_rad_s": approx(0.7, rel=0.06)}) for how
        in ("held", "linear")),
    Study("a servo at its limit, steps between stamps", simulated(RATE_LIMITED.format(a=0.03, q=0.1,
        rate=1.2) + 'seed: 2\nloop_hz: 250\nunit_s: 0.36\nmaneuvers: ["3211", "rev", doublet, "rev",'
        ' "3211"]\n'), named=["actuator_rate_limit"]),
    Study("a delay of another engine's aircraft",
        simulated(C172 + "effects: {transport_delay: {delay_s: 0.06}}"), "effect", first="transport_delay"),
    Study("a delay within that of telemetry", Setup(maneuvers=4, switches={"delay": 0.02}, seed=72),
        named=[]),
    Study("a delay beyond that of telemetry", Setup(maneuvers=4, switches={"delay": 0.05}, seed=72),
        named=["transport_delay"]),
    Study("a delay in two manoeuvres", Setup(maneuvers=2, switches={"delay": 0.06}, seed=3),
        first="transport_delay", says=("Only 2 manoeuvres",), file=believed()),
    Study("a delay in a log of twice the rate", six({"delay": 0.05}, rate_hz=100.0, seed=72),
        first="transport_delay", sizes={"delay_s": approx(0.05, abs=0.003)}),
    Study("play below a tenth of a degree, in a quiet record", six({"play": 0.0012}, noise=0.002, seed=71),
        named=["actuator_backlash"], sizes={"half_width_rad": approx(0.0012, rel=0.05)}),
    Study("a dead band that moves with the trim", dead_band_about_each_trim, named=["actuator_deadband"],
        sizes={"half_width_rad": approx(0.012, rel=0.05)}, says=("around its trim",)),
    Study("a servo of second order", Setup(maneuvers=5, switches={"lag": 0.03, "before_lag": 0.03}, seed=43),
        "effect", holds=lambda d: d.causes[0].effect in ("actuator_lag", "transport_delay")),
    Study("a servo that is late and lags", Setup(maneuvers=5, switches={"delay": 0.04, "lag": 0.04}, seed=43),
        "effect", holds=lambda d: d.causes[0].effect in ("actuator_lag", "transport_delay")),
    Study("a servo's lag beside an autopilot's own angle of attack",
        lambda: estimated(fly(six({"lag": 0.08}, seed=71))), named=["actuator_lag"]),
    *(Study(f"a surface that stops at {least} and {most} rad", replace(setup,
        switches={"stop_low": least, "stop_high": most}), "unknown", "input",
        says=("The surface stops before the command does", angle)) for setup, least, most, angle
        in ((six(seed=40), -0.05, 0.035, "2.0"), (Setup(seed=40), -0.045, 0.5, "2.6"))),
    *(Study(f"a servo that sticks until it breaks loose, {air}", setup, "unknown", "input",
        says=("The surface sticks",)) for air, setup in (("in still air", six(STICKING, seed=44)),
        ("in gusts", hard(STICKING)))),
    *(Study(f"a servo that overshoots at {hz} Hz", replace(setup, switches={"ring_hz": hz, "ring_zeta": 0.2}),
        "unknown", "input", says=("The surface overshoots its command",)) for setup, hz
        in ((Setup(maneuvers=5, seed=42), 4.0), (hard(), 2.5))),
    Study("a servo that rings, later in the file than it is", six({"ring_hz": 3.0, "ring_zeta": 0.12},
        seed=44), "unknown", "input", [], says=("The surface overshoots its command",),
        file=with_servo(lag_s=0.03)),
    *(Study(f"an elevator that loses power in flight, {air}", weakened(setup), "unknown", "input",
        says=("elevator's power changed by -3",)) for air, setup in (("in still air", six(seed=39)),
        ("in gusts", hard()))),

    # Instruments.
    *(Study(f"a {effect}, noise with a memory and jitter", six(coloured=0.6, jitter=0.004, seed=7, **changes),
        "effect", first=effect) for effect, changes in (("alpha_lag", {"switches": {"vane_lag": 0.04}}),
        ("accelerometer_skew", {"skew": {"a_z": 0.03}}), ("nonlinear_pitching_moment",
        {"switches": {"cm_a2": -3.0}}), ("mass_change", {"mass_step": 0.15}))),
    *(Study(f"a message that is late by {late_s} s", six(skew={"q": late_s, "theta": late_s},
        attitude_brings_q=True, seed=6), named=["attitude_skew"], sizes={"skew_s": approx(late_s, abs=0.004),
        "with_pitch_rate": 1.0}, says=("Attitude and pitch rate are stamped",)) for late_s in (0.05, -0.03)),
    Study("a faint error of an instrument in still air", six(alpha_scale=0.03, noise=0.03, seed=5),
        named=["alpha_scale"], sizes={"scale": approx(0.03, abs=0.01)}, holds=lambda d: d.gap.before < 0.05),
    Study("an angle of attack that comes early is no vane that lags", six(skew={"alpha": -0.015}, seed=31),
        first="alpha_skew", sizes={"skew_s": approx(-0.015, abs=0.003)},
        holds=lambda d: all(c.effect != "alpha_lag" for c in d.causes)),
    Study("a pitch rate that is late and nothing else", six(skew={"q": 0.05}, seed=52), "effect",
        first="pitch_rate_skew"),
    Study("a pitch rate early by a radian of the short period", Setup(maneuvers=4, skew={"q": -0.14},
        seed=71), named=["pitch_rate_skew"], sizes={"skew_s": approx(-0.14, abs=0.002)}),
    Study("a pitch rate that is off in every manoeuvre is no slow noise",
        six(q_bias=0.02, noise=0.004, seed=61), first="pitch_rate_bias",
        sizes={"bias_rad_s": approx(0.02, rel=0.1)}),
    Study("a pitch rate that is off in turns", Setup(maneuvers=5, banks_deg=BANKS, q_bias=0.01),
        first="pitch_rate_bias", sizes={"bias_rad_s": approx(0.01, abs=0.001)}),
    Study("a pitch rate that reads high", reading(six(seed=38), "q", read(lambda y: 1.08 * y)),
        named=["pitch_rate_scale"]),
    Study("a pitch rate that is off beside a reading out of proportion",
        reading(hard(q_bias=0.02), "a_z", read(lambda y: 1.07 * y)), first="pitch_rate_bias"),
    Study("an arm that the file leaves open, before next to nothing",
        six({"acc_arm": 1.5, "cl_a2": -3.0}, noise=0.005, seed=10), first="accelerometer_offset",
        file=believed()),
    Study("an arm that numbers imitate", six({"acc_arm": -2.5}, noise=0.002, seed=18), "effect",
        first="accelerometer_offset", sizes={"arm_m": approx(-2.5, rel=0.05)},
        file=wrong_file(M_q=0.8, Z_alpha=1.08)),
    *(Study(f"a vane's lag that is a third longer in the end, {air}", lagging_more_and_more(setup), "effect",
        first="alpha_lag") for air, setup in (("in still air", Setup(maneuvers=8, seed=62)),
        ("in gusts", Setup(maneuvers=8, gust_std=0.1, coloured=0.5, jitter=0.003, speed_change=0.03,
        seed=63)))),
    Study("a vane that jumps now and then", lambda: reading(six(seed=22), "alpha", jumping())(), "unknown",
        "alpha_sensor"),
    Study("a vane that sticks for long", reading(six(seed=29), "alpha", stuck), "unknown", "alpha_sensor"),
    *(Study(f"a vane that rubs, {air}", lambda setup=setup: through_vane(setup, lambda y: rubbed(y, 0.006))(),
        "unknown", "alpha_sensor", says=("bearing rubs: the air turns by 0.3 deg before it follows",))
        for air, setup in (("in still air", six(seed=3)), ("in gusts", hard(maneuvers=9)))),
    *(Study(f"a vane that meets a stop, {air}", lambda setup=setup: through_vane(setup,
        lambda y: np.minimum(y, 0.09))(), "unknown", "alpha_sensor", says=("it meets a stop",)) for air, setup
        in (("in still air", Setup(seed=3)), ("in gusts", hard(maneuvers=9)))),
    Study("a gyro that saturates", saturating, "unknown", "pitch_rate_sensor"),
    *(Study(f"a gyro that feels the acceleration, {air}", feeling(setup, felt), "unknown",
        "pitch_rate_sensor", says=("The acceleration disturbs the measured pitch rate.",)) for air, setup,
        felt in (("in still air", six(seed=38), lambda pull: 0.003 * pull**2),
        ("in gusts", hard(), lambda pull: -0.012 * pull))),
    Study("an attitude that reads high, in gusts", reading(hard(maneuvers=9), "theta",
        read(lambda y: 1.1 * y)), "unknown", "attitude_sensor", holds=lambda d: not {c.effect for c
        in d.causes if c.present} - {"turbulence", "gust", "alpha_bias"}),
    *(Study(f"a bent reading of {channel} that {says}", reading(hard(maneuvers=9), channel, read(bent)),
        "unknown", block, says=(says,)) for channel, bent, block, says
        in (("alpha", lambda y: np.minimum(y, np.median(y) + 0.04), "alpha_sensor", "meets a stop"),
        ("a_z", lambda y: np.maximum(y, -14.0), "accelerometer", "is not linear"),
        ("a_z", lambda y: y + 0.02 * (y + 9.8) ** 2, "accelerometer", "is not linear"))),
    Study("an accelerometer that does not carry the weight", reading(Setup(gust_std=2.0, coloured=0.5,
        jitter=0.004, seed=37), "a_z", read(lambda y: 0.78 * y)), "unknown", "accelerometer",
        says=("reads 0.78",)),
    Study("an accelerometer in air in which the dynamics tell nothing",
        Setup(gust_std=2.0, coloured=0.5, jitter=0.004, seed=37),
        holds=lambda d: d.where.block != "accelerometer"),
    *(Study(f"a {channel} behind a filter of {late_s} s", reading(six(seed=51), channel,
        through_filter(late_s, shape)), "unknown", block, holds=lambda d,
        late_s=late_s: float(next(n for n in d.notes if "passes a filter"
        in n).split("it is ")[1].split(" ms")[0]) == approx(1e3 * late_s, abs=8.0)) for channel, late_s,
        shape, block in (("q", 0.1, 0.5, "pitch_rate_sensor"), ("theta", 0.16, 0.0, "attitude_sensor"),
        ("a_z", 0.1, 0.0, "accelerometer"))),

    # Forces, moments, mass.
    *(Study(f"a {effect} that bends about {'each trim' if about is None else about}, {switches}",
        Setup(maneuvers=8, speed_change=speed, seed=int(100 * speed),
        switches=switches | ({} if about is None else {"bends_about": about})), "effect", named=[effect],
        holds=lambda d: d.gap.after < 0.1 * d.gap.before) for about in (0.08, None) for effect, switches,
        speed in (("nonlinear_pitching_moment", {"cm_a2": 3.0}, 0.15),
        ("nonlinear_pitching_moment", {"cm_a3": -80.0}, 0.22), ("nonlinear_lift", {"cl_a3": -150.0}, 0.15))),
    *(Study(f"flow that separates within a degree or two at {at} rad is no gust",
        six({"kink_at": at}, seed=seed), "effect", first="nonlinear_lift", holds=shrinks_by(90.0)) for at,
        seed in ((0.07, 11), (0.10, 12))),
    *(Study(f"a wing that stalls deeply at {at} rad", six({"stall_at": at}, airframe=PULLED, gust_std=gust,
        seed=seed), "effect", first="nonlinear_lift") for at, gust, seed
        in ((0.08, 0.0, 11), (0.075, 0.1, 12))),
    *(Study(f"lift that builds up late with {moment} of the moment",
        six({**LATE_LIFT, "moment_lags": moment}, seed=15), named=["unsteady_lift"],
        sizes={"share": approx(0.35, abs=0.08), "lag_s": approx(0.2, rel=0.2)}, holds=lambda d,
        moment=moment: ("with_moment" in d.causes[0].parameters) == bool(moment)) for moment in (0.0, 1.0)),
    Study("lift that hardly comes at all at first", six({"lift_lag": 0.12, "lift_lag_share": 0.85,
        "moment_lags": 1.0}, noise=0.005, seed=15), file=right_file, holds=lambda d: "unsteady_lift"
        in [c.effect for c in d.causes if c.present]),
    Study("a lift slope that grows near the ground", six({"ground": 0.3}, heights_m=(6.0, 9.0, 60.0),
        seed=13), "effect", first="ground_effect"),
    *(Study(f"a large aircraft whose lift slope grows by {share} near the ground",
        six({"ground": share}, airframe=LARGE, heights_m=(27.0, 29.0, 24.0), seed=14), "effect",
        first="ground_effect") for share in (0.1, 0.2)),
    Study("a manoeuvre in which the aircraft departed is left out",
        six({"ground": 1.0}, heights_m=(6.0, 60.0, 60.0), seed=13),
        holds=lambda d: len(d.gap.by_maneuver) == 4),
    Study("stability that drops by a third is no ice", six(cg_step=-0.35, seed=16), named=["cg_shift"],
        sizes={"step": approx(-0.35, abs=0.02)}),
    Study("a change between two manoeuvres leaves none out", Setup(maneuvers=8, cg_step=-0.25, seed=25),
        first="cg_shift", holds=lambda d: d.maneuvers == tuple(range(1, 9))),
    Study("a change of mass is no gust", Setup(maneuvers=4, mass_step=0.3, seed=3), first="mass_change"),
    Study("thrust off the centre of gravity", six({"thrust_arm": 0.02}, thrust_amplitude=0.5,
        thrust_moves_in=EVERY, seed=4), "effect", first="thrust_moment", holds=shrinks_by(70.0)),
    Study("an engine that lags its throttle", six({"thrust_arm": 0.05}, thrust_amplitude=0.5,
        engine_lag_s=0.6, seed=4), "effect", first="thrust_moment", says=("ms behind the throttle",),
        holds=lambda d: off(d, "lag_s", 0.6) < 3.0 and d.causes[0].parameters["lag_s"].std < 0.07),
    Study("thrust that two manoeuvres alone tell", six({"thrust_arm": 0.3}, thrust_amplitude=0.6,
        thrust_moves_in=(0, 3), seed=71), first="thrust_moment"),
    *(Study(f"a structure that swings, {integrated} of it in the attitude",
        six({**BENDING, "mode_attitude": integrated}, seed=16), named=["structural_mode"],
        sizes={"frequency_hz": approx(4.0, rel=0.03)}, holds=lambda d,
        integrated=integrated: ("with_attitude" in d.causes[0].parameters) == bool(integrated)) for integrated
        in (0.0, 1.0)),
    Study("forces that grow with a power of 1.2", six({"speed_power": -0.8}, speed_change=0.12, seed=8),
        named=["airspeed_variation"], holds=lambda d: off(d, "exponent", -0.8) < 2.5
        and re.search("with (its power )?1.2", d.sentence) and len(d.waterfall) == 1),
    Study("moments that grow with another power than the lift", six({"moment_power": -1.5}, speed_change=0.12,
        seed=8), named=["airspeed_variation"], sizes={"exponent_M": approx(-1.5, abs=0.35),
        "exponent": approx(0.0, abs=0.25)}, says=("moments grow with the air speed's power 0.",)),
    *(Study(f"a moment of the angle's rate of {cm}, by the file's numbers", six({"cm_alphadot": cm}, seed=25),
        "effect", first="alpha_dot", file=lambda: number_file(6, 0.01, 24), holds=lambda d,
        cm=cm: d.causes[0].parameters["M_alpha_dot"].value * cm > 0.0) for cm in (-8.0, -25.0, 6.0)),
    *(Study(f"a force or a moment that bends, {switches}, is no instrument's fault", hard(switches), "effect",
        holds=lambda d: d.where.block in ("force_equation", "moment_equation")) for switches
        in ({"cl_a2": -9.0}, {"cl_a3": -160.0}, {"cm_a2": 4.0}, {"kink_at": 0.12})),
    *(Study(f"lift that comes back another way, {lost} of it, gusts of {gust} m/s",
        six({**CLIPPED_LIFT, "lost_cl": lost}, gust_std=gust, seed=46), "unknown", "force_equation") for lost,
        gust in ((0.06, 0.12), (0.12, 0.0))),
    Study("lift that is lost with the pitch rate", hard({"cl_q_abs": -0.25}), "unknown", "force_equation",
        says=("The lift is not linear in the pitch rate",)),
    *(Study(f"damping that bends, {switches}, {air}", replace(setup, switches=switches), "unknown",
        "moment_equation", says=(says,)) for air, setup in (("in gusts", hard()),
        ("in still air", Setup(seed=8))) for switches, says in (({"q_abs": -0.02},
        "not the same up and down"), ({"q_square": -0.06}, "not the same up and down, or fast and slow"),
        ({"cm_aq": -90.0}, "changes with the angle of attack"))),

    # Air.
    Study("moving air", six(gust_std=0.5, seed=2), first="turbulence", block="air"),
    Study("moving air is held against instruments", six(gust_std=0.4, seed=34), named=["turbulence"],
        holds=lambda d: 0.0 < d.gap.after < 0.1 * d.gap.before),
    *(Study(f"a gust of {peak} m/s that passes in some of {n}", Setup(maneuvers=n, gust_pulse=peak, seed=seed,
        **changes), named=["gust"], sizes={"amplitude_m_s": approx(peak, rel=0.35)}) for n, peak, seed,
        changes in ((6, 0.12, 26, {"coloured": 0.5}), (6, 0.2, 26, {"coloured": 0.5}), (9, 0.25, 2, {}))),
    *(Study(f"a gust of {peak} m/s in one of {n} manoeuvres is no change",
        Setup(maneuvers=n, gust_pulse=peak, seed=seed), named=["gust"], holds=lambda d,
        n=n: d.maneuvers == tuple(range(1, n + 1))) for n, peak, seed in ((3, 2.0, 26), (4, 1.0, 3))),

    # Two effects.
    Study("of a delay and a scale the larger is first", six({"delay": 0.06}, alpha_scale=0.1, seed=23),
        named=["transport_delay", "alpha_scale"]),
    Study("three streams late alike are a late command and an early stream",
        six({"delay": 0.06}, noise=0.005, skew={"alpha": -0.06}, seed=40),
        sizes={"delay_s": approx(0.06, abs=0.005)}, holds=lambda d: {c.effect for c in d.causes
        if c.present} == {"transport_delay", "alpha_skew"} and {c.effect: c.parameters for c
        in d.causes}["alpha_skew"]["skew_s"].value == approx(-0.06, abs=0.005)),
    Study("each of two effects has the size it has beside the other",
        six(alpha_scale=0.19, skew={"a_z": 0.047}, seed=5), holds=lambda d: {c.effect: c.parameters[n].value
        for c, n in zip([c for c in d.causes if c.present], ("scale", "skew_s"),
        strict=True)} == approx({"alpha_scale": 0.19, "accelerometer_skew": 0.047}, abs=0.012)),
    Study("a waterfall ends at the gap that stays", cut_short, holds=lambda d: len(d.waterfall) > 1
        and d.waterfall[-1][1] == approx(d.gap.after, rel=1e-9, abs=1e-12)),

    # Effects that the file has.
    Study("a delay that the file has", six({"delay": 0.06}, seed=21), "none",
        file=having(transport_delay={"delay_s": 0.06})),
    *(Study(f"a delay of which the file has {s} s", six({"delay": 0.06}, seed=21), named=["transport_delay"],
        sizes={"delay_s": approx(0.06 - s, abs=0.003)}, file=having(transport_delay={"delay_s": s})) for s
        in (0.02, 0.11)),
    *(Study(f"a delay of {s} s in the file, off by less than telemetry may be late",
        six({"delay": 0.06}, seed=21), "none", named=[], file=having(transport_delay={"delay_s": s})) for s
        in (0.04, 0.08)),
    Study("an offset of the angle of attack", six(alpha_bias=0.02, seed=22), first="alpha_bias"),
    Study("an offset of the angle of attack that the file has", six(alpha_bias=0.02, seed=22), "none",
        file=having(alpha_bias={"bias_rad": 0.02})),
    Study("what belongs to another flight is left aside", six({"delay": 0.06}, seed=21),
        first="transport_delay", says=("icing, gust", "not used"),
        file=having(icing={"Z_alpha": -0.2}, gust={"amplitude_m_s": 2.0})),
    Study("of a late channel only what the file lacks", six(skew={"alpha": 0.08}, seed=23),
        first="alpha_skew", sizes={"skew_s": approx(0.03, abs=0.004)},
        file=having(alpha_skew={"skew_s": 0.05})),
    Study("too much of an effect in the file", six({"lag": 0.05}, seed=21),
        sizes={"lag_s": approx(-0.05, abs=0.01)}, says=("too slow: its servo lags by 5",),
        file=having(actuator_lag={"lag_s": 0.1})),

    # An effect put into a flight of ArduPlane: real rates, filters and stamps.
    *(Study(f"a {effect} of {size:.2f} in ArduPlane's flight", put_into(channel, change), "effect",
        first=effect, sizes={name: approx(size, rel=0.15)}, file=lambda: Aircraft(elevator=SERVO))
        for channel, change, effect, name, size in (("elevator", later(-0.06), "transport_delay", "delay_s",
        0.06), ("q", read(lambda y: 0.85 * y), "pitch_rate_scale", "scale", -0.15),
        ("q", read(lambda y: y + np.radians(1.2)), "pitch_rate_bias", "bias_rad_s", np.radians(1.2)),
        ("a_z", later(0.08), "accelerometer_skew", "skew_s", 0.08))),
    Study("ArduPlane's servo, whose lag the file lacks", arduplane, "effect", first="actuator_lag",
        sizes={"lag_s": approx(0.14, abs=0.025)}, file=lambda: Aircraft(elevator=replace(SERVO, lag_s=None)),
        holds=lambda d: off(d, "lag_s", 0.14) < 3.0 and d.causes[0].parameters["lag_s"].std < 0.02),
]
# fmt: on
