"""A flight test made by hand: simulated manoeuvres with estimates and verdicts of known values."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from advisor.aircraft.aircraft import Aircraft, CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.campaign.state import AxisState, CampaignState, ChannelStatus, JudgedManeuver, WholeFlight
from advisor.decision.inputs import StepInput
from advisor.decision.verdict import (
    FlightTestVerdict,
    ManeuverVerdict,
    NextInput,
    Reason,
    Remaining,
    RuleProgress,
    RuleResult,
)
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import Course
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.oem.estimate import ChannelFit, Estimate, NoEstimate
from advisor.words.quantities import clock

TRUTH = np.array([0.04, -3.2, 0.02, -0.21, 0.47, -48.0, -4.2, -101.0])
SPREAD = np.array([0.004, 0.15, 0.01, 0.05, 0.05, 1.9, 0.3, 4.0])
NOISE = {"alpha": 0.002, "q": 0.01, "theta": 0.002, "a_z": 0.3}
STEPS = ((0.0, 1.2, -1.0), (1.2, 2.0, 1.0), (2.0, 2.4, -1.0), (2.4, 2.8, 1.0))
CRITERION = (None, None, 61.0, 38.0, 31.0, 27.5, 18.2)
AIRCRAFT = Aircraft(
    name="test glider",
    model=dict(zip(PARAMETERS, (float(v) for v in TRUTH * 1.1), strict=True)),
    campaign=CampaignPlan(),
)
VEHICLE = Vehicle(1, 1, "ardupilot", 1)


@cache
def response(
    direction: float, seconds: float = 8.0
) -> tuple[NDArray[np.float64], Mapping[str, NDArray[np.float64]]]:
    """Stamps (n,) at 50 Hz from 2 s before the first step, and the noise-free channels."""
    t = np.arange(-2.0, seconds, 0.02)
    elevator = np.zeros_like(t)
    for start, end, level in STEPS:
        elevator[(t >= start) & (t < end)] = np.radians(2.0) * level * direction
    states = np.zeros((len(t), 3))
    for k in range(len(t) - 1):
        alpha, q, _ = states[k]
        rates = np.array(
            [
                TRUTH[1] * alpha + (1.0 + TRUTH[2]) * q + TRUTH[3] * elevator[k],
                TRUTH[5] * alpha + TRUTH[6] * q + TRUTH[7] * elevator[k],
                q,
            ]
        )
        states[k + 1] = states[k] + 0.02 * rates
    alpha, q, theta = states.T
    a_z = 26.0 * (np.gradient(alpha, t) - q) - 9.81
    return t, {"elevator": elevator, "alpha": alpha + 0.05, "q": q, "theta": theta + 0.05, "a_z": a_z}


def judged(
    number: int, accepted: bool = True, outputs: tuple[str, ...] = ("alpha", "q", "a_z", "theta")
) -> JudgedManeuver:
    """Manoeuvre ``number``, flown in the order of the paper, 25 s after the one before."""
    random = np.random.default_rng(number)
    start_s = 80.0 + 25.0 * number
    direction = -1.0 if number in (2, 3, 5, 7) else 1.0
    t, clean = response(direction if accepted else 0.15 * direction)
    fits = {}
    channels = {
        "elevator": Channel(
            "elevator", t + start_s, clean["elevator"], "SERVO_OUTPUT_RAW.servo2_raw", "commanded"
        )
    }
    for name in outputs:
        measured = clean[name] + random.normal(0.0, NOISE[name], len(t))
        channels[name] = Channel(name, t + start_s, measured)
        fits[name] = ChannelFit(name, t + start_s, measured, clean[name], NOISE[name])
    span = Span(
        record_from_s=start_s - 2.0,
        start_s=start_s,
        last_step_s=start_s + 2.8,
        end_s=start_s + 8.0,
        kind="3-2-1-1" if direction > 0.0 else "reverse 3-2-1-1",
        steps=tuple((start_s + begin, np.radians(2.0) * level * direction) for begin, _, level in STEPS),
        closed_by="quiet",
    )
    return JudgedManeuver(
        Maneuver(number, 0, span, channels, "MANUAL"), _estimate(fits, random), _verdict(number, accepted)
    )


def without_estimate(number: int) -> JudgedManeuver:
    """A manoeuvre that could not be estimated."""
    whole = judged(number, accepted=False)
    return JudgedManeuver(
        whole.maneuver, NoEstimate("singular", "The input did not move the aircraft."), whole.verdict
    )


def _estimate(fits: Mapping[str, ChannelFit], random: np.random.Generator) -> Estimate:
    covariance = np.diag(SPREAD**2)
    return Estimate(
        theta=TRUTH + random.normal(0.0, SPREAD),
        covariance_cr=covariance / 9.0,
        covariance=covariance,
        cost=1.2e-9 * float(random.uniform(0.7, 1.5)),
        fits=(fits,),
        iterations=4,
        not_identifiable={"Z_q": "Z_q cannot be told from Z_alpha with this input."},
        correlated=(("Z_alpha", "Z_q", 0.97),),
        condition=230.0,
        airspeed_m_s=26.1,
    )


def _verdict(number: int, accepted: bool) -> ManeuverVerdict:
    rules = {
        "continuous": RuleResult(accepted, 2.4e-9),
        "separate": RuleResult(accepted and number % 2 == 1, 1.1e-9),
        "information": RuleResult(accepted, None),
    }
    cautions = ("alpha is derived by the autopilot: it does not see gusts.", "servo dynamics unknown.")
    if accepted:
        return ManeuverVerdict(True, "GOOD: rich input, 98 % of the motion explained.", (), rules, cautions)
    text = "too gentle, pitch rate 3 deg/s; use about 1.5 times the stick"
    reasons = (Reason("amplitude", f"{text}.", 3.1, 5.0), Reason("bank", "bank reached 43 deg.", 43.0, 30.0))
    return ManeuverVerdict(False, f"REPEAT: {text}.", reasons, rules, cautions)


def _progress(stopped_at: int | None, history: Sequence[float | None], factor: float) -> RuleProgress:
    """The progress of a rule, whose criterion is this multiple of the history."""
    values = tuple(v and factor * v for v in history)
    return RuleProgress(stopped_at, values, now_percent=values[-1] if values else None)


def state(flown: int = 7, bad: tuple[int, ...] = (2,), in_the_air: bool = False) -> CampaignState:
    """The campaign after ``flown`` manoeuvres, those in ``bad`` rejected, one more in the air if wanted."""
    maneuvers = tuple(judged(k, accepted=k not in bad) for k in range(1, flown + 1))
    history = CRITERION[:flown]
    criterion = history[-1] if history else None
    stop = criterion is not None and criterion < 25.0
    now_s = 80.0 + 25.0 * flown + 20.0
    sentence = (
        "The criterion is below its limit: you may stop testing." if stop else "Fly the next manoeuvre."
    )
    verdict = FlightTestVerdict(
        rule="continuous",
        decision="stop" if stop else "continue",
        sentence=sentence,
        criterion_percent=criterion,
        limit_percent=25.0,
        stopped_at=flown if stop else None,
        by_rule={
            "continuous": _progress(flown if stop else None, history, 1.0),
            "separate": _progress(None, history, 1.4),
            "information": replace(_progress(None, history, 4.0), limit_percent=100.0),
        },
        next=NextInput(
            "next: reverse 3-2-1-1, 0.4 s steps, 60 % stick",
            Remaining(2, 4),
            "Z_delta_e",
            StepInput("3-2-1-1", 0.4, np.radians(15.0), nose_up_first=False),
        ),
        warnings=("Z_q is near zero: the criterion of Eq. (12) cannot fall for it.",),
    )
    flying = _in_the_air(flown + 1) if in_the_air else None
    channels = {
        name: ChannelStatus(source, provenance, rate, 0.06, now_s, newest=newest)
        for name, source, provenance, rate, newest in (
            ("elevator", "SERVO_OUTPUT_RAW.servo2_raw", "commanded", 49.8, 0.01),
            ("alpha", "AOA_SSA.AOA", "derived", 20.0, 0.05),
            ("q", "ATTITUDE.pitchspeed", "measured", 50.0, 0.0),
            ("theta", "ATTITUDE.pitch", "measured", 50.0, 0.05),
            ("bank", "ATTITUDE.roll", "measured", 50.0, 0.07),
            ("a_z", "RAW_IMU.zacc", "measured", 50.0, -9.8),
            ("airspeed", "VFR_HUD.airspeed", "measured", 10.0, 25.9),
        )
    }
    notices = tuple(
        f"{clock(clock_s):>7}  manoeuvre {k} judged"
        for k, clock_s in enumerate(np.arange(113.0, now_s, 25.0), 1)
    )
    model = _estimate({}, np.random.default_rng(0)) if flown else None
    return CampaignState(
        vehicle=VEHICLE,
        now_s=flying.span.end_s if flying else now_s,
        mode="MANUAL",
        channels=channels,
        axes={"pitch": AxisState(maneuvers, verdict, model)},
        flying=flying,
        whole_flight=_whole(maneuvers, now_s),
        notices=("      –  following ardupilot 1/1", *notices),
        serves=True,
    )


def _whole(maneuvers: tuple[JudgedManeuver, ...], now_s: float) -> WholeFlight:
    """The flight as one picture: every channel at rest but for the manoeuvres."""
    t = np.arange(40.0, now_s, 0.5)
    busy = np.zeros(len(t))
    for judged in maneuvers:
        span = judged.maneuver.span
        busy[(t >= span.start_s) & (t < span.end_s)] = 0.1
    courses = {name: Course(t, -busy, busy) for name in ("elevator", "alpha", "q")}
    courses["airspeed"] = Course(t, 26.0 - busy, 26.0 + busy)
    return WholeFlight(courses, ((40.0, "FBWA"), (80.0, "MANUAL")))


def _in_the_air(number: int) -> Maneuver:
    """The first four seconds of a manoeuvre."""
    whole = judged(number).maneuver
    end_s = whole.span.start_s + 4.0
    channels = {name: c.cut(whole.span.record_from_s, end_s) for name, c in whole.channels.items()}
    span = Span(
        whole.span.record_from_s,
        whole.span.start_s,
        end_s,
        end_s,
        whole.span.kind,
        whole.span.steps,
        "",
    )
    return Maneuver(number, 0, span, channels, "MANUAL")
