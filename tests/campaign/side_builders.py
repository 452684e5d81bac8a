"""Hand-made states of the lateral half of a campaign, with the estimates of a jet."""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import JudgedManeuver, LateralState
from advisor.decision.axes.lateral_stop import lateral_flight_test
from advisor.decision.verdict import ManeuverVerdict, Reason
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.model.axes.lateral import LATERAL, Trim
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import Errors, modes_of
from advisor.oem.estimate import ChannelFit
from tests.oem.axis.builders import JET, vector

T = np.arange(0.0, 10.0, 0.04)
AIRCRAFT = Aircraft(name="jet", model=JET)
_BANKED = Reason("bank", "bank reached 60 deg (limit 45); less aileron, or shorter", 60.0, 45.0)


def estimate(*flown, percent=2.0, untold=None, fits=()):
    """Return an estimate of the jet with equal relative errors."""
    std = 0.01 * percent * np.maximum(np.abs(vector(JET)), 0.1)
    covariance = np.diag(std**2)
    errors = Errors(covariance, np.zeros((1, 15)))
    modes, _ = modes_of(LATERAL, vector(JET), errors, Trim(130.0).around)
    return AxisEstimate(
        theta=vector(JET), covariance_cr=covariance, covariance=covariance,
        common=0.0 * covariance, cost=1e-9, fits=fits, iterations=3, not_identifiable=untold or {},
        correlated=(), condition=1.0, airspeed_m_s=130.0,
        names=LATERAL.names.reported, nuisances={}, flown=flown, modes=modes,
        of_still=tuple(term.name for term in LATERAL.shared if term.factor not in (*flown, *LATERAL.states)),
    )  # fmt: skip


def judged(number, control, *, accepted=True):
    """Return a judged doublet, 1 s a step, that begins 2 s into its record."""
    start_s = 100.0 + 30.0 * number
    t = start_s - 2.0 + T
    move = 0.07 * (np.sign(T - 2.0) - 2.0 * np.sign(T - 3.0) + np.sign(T - 4.0)) / 2.0
    still = np.zeros_like(T)
    moved = {"aileron": still, "rudder": still, control: move}
    motion = {name: 0.3 * np.sin(T) for name in ("p", "r", "bank", "a_y")}
    channels = {
        name: Channel(name, t, y, "test", "measured")
        for name, y in {**moved, **motion, "theta": still + 0.105, "alpha": still + 0.07}.items()
    }
    span = Span(
        t[0], start_s, start_s + 2.0, t[-1], "aileron doublet" if control == "aileron" else "rudder doublet",
        ((start_s, 0.07), (start_s + 1.0, -0.07), (start_s + 2.0, 0.0)), "quiet",
    )  # fmt: skip
    fits = ({name: ChannelFit(name, t, y, 0.99 * y, 0.001) for name, y in motion.items()},)
    verdict = ManeuverVerdict(accepted, "accepted", (), {})
    if not accepted:
        verdict = replace(verdict, sentence=f"REPEAT: {_BANKED.text}", reasons=(_BANKED,))
    return JudgedManeuver(
        Maneuver(number, 0, span, channels, "MANUAL"), estimate(control, fits=fits), verdict
    )


def state(*maneuvers, aircraft=AIRCRAFT, model=None):
    """Return the state after these manoeuvres."""
    history = [one.estimate if one.verdict.accepted else None for one in maneuvers]
    accepted = tuple(one.maneuver.number for one in maneuvers if one.verdict.accepted)
    return LateralState(
        maneuvers,
        lateral_flight_test(history, model or estimate("aileron", "rudder"), aircraft),
        model or estimate(),
        accepted,
    )
