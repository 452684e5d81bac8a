"""Results of ``advisor simulator check`` as text and as a document."""

from collections.abc import Iterator, Mapping
from math import degrees, isfinite, tau
from typing import Any

from advisor.simulators.check import CheckedSimulator
from advisor.words.digits import with_half
from advisor.words.plain import picked
from advisor.words.quantiles import NORMAL_95

SCHEMA = "advisor.simulator/1"
_LACKS = {
    "increments": "the diagnosis cannot fly effects of force and moment",
    "mass": "the simulator flies at its own mass",
    "wind": "the simulator flies in still air",
    "throttle": "the flight's throttle movements are not flown",
    "aileron": "the flight's aileron is not flown",
    "rudder": "the flight's rudder is not flown",
}


def document(checked: CheckedSimulator) -> dict[str, Any]:
    """Return the ``advisor.simulator/1`` document."""
    fault = checked.fault
    return {
        "schema": SCHEMA,
        "usable": fault is None,
        **picked(checked, "simulator airspeed_m_s height_m alpha_rad trim a_z_m_s2 rest_q_rad_s takes lacks"),
        **picked(checked, "derivatives std side lag_s dead_time_s omega_rad_s damping notes"),
        "problems": []
        if fault is None
        else [picked(fault.refuse(checked.simulator).problem, "code text fix")],
    }


def lines(checked: CheckedSimulator) -> Iterator[str]:
    """Yield the results of the check, one per line."""
    yield f"{checked.simulator} at {checked.airspeed_m_s:.4g} m/s true air speed, {checked.height_m:.0f} m"
    controls = "".join(f", {name} {_control(name, value)}" for name, value in checked.trim.items())
    yield f"trim        α {degrees(checked.alpha_rad):+.2f} deg{controls}"
    turns = f"pitch rate below {degrees(checked.rest_q_rad_s):.3f} deg/s"
    yield f"at rest     a_z {checked.a_z_m_s2:+.2f} m/s², {turns}"
    if checked.fault is not None:
        return
    yield "signs       a_z down, α and q nose up: kinematically consistent"
    yield "units       rad, rad/s, m/s²: kinematically consistent"
    yield f"elevator    dead time {1e3 * checked.dead_time_s:.0f} ms, lag {1e3 * checked.lag_s:.0f} ms"
    if isfinite(checked.damping):
        hertz = checked.omega_rad_s / tau
        yield f"short period {checked.omega_rad_s:.2f} rad/s ({hertz:.2f} Hz), damping {checked.damping:.2f}"
    else:
        yield "short period none: the simulator is statically unstable at this speed"
    yield f"numbers     {_with_errors(checked.derivatives, checked.std)}"
    if checked.side:
        yield f"roll, yaw   {_with_errors(checked.side, checked.std)}"
    yield "            ±: half the 95 % interval, including motion that a linear model does not describe"
    yield f"takes       elevator{''.join(f', {name}' for name in checked.takes)}"
    for name in checked.lacks:
        yield f"does not take {name}: {_LACKS[name]}"
    yield from checked.notes


def _with_errors(values: Mapping[str, float], std: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {with_half(value, NORMAL_95 * std[name])}" for name, value in values.items())


def _control(name: str, value: float) -> str:
    return f"{100.0 * value:.0f} %" if name == "throttle" else f"{degrees(value):+.2f} deg"
