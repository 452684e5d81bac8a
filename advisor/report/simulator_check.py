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


def document(found: CheckedSimulator) -> dict[str, Any]:
    """Return the ``advisor.simulator/1`` document."""
    fault = found.fault
    return {
        "schema": SCHEMA,
        "usable": fault is None,
        **picked(found, "simulator airspeed_m_s height_m alpha_rad trim a_z_m_s2 rest_q_rad_s takes lacks"),
        **picked(found, "derivatives std side lag_s dead_time_s omega_rad_s damping notes"),
        "problems": [] if fault is None else [picked(fault.refuse(found.simulator).problem, "code text fix")],
    }


def lines(found: CheckedSimulator) -> Iterator[str]:
    """Yield the results of the check, one per line."""
    yield f"{found.simulator} at {found.airspeed_m_s:.4g} m/s true air speed, {found.height_m:.0f} m"
    controls = "".join(f", {name} {_control(name, value)}" for name, value in found.trim.items())
    yield f"trim        α {degrees(found.alpha_rad):+.2f} deg{controls}"
    turns = f"pitch rate below {degrees(found.rest_q_rad_s):.3f} deg/s"
    yield f"at rest     a_z {found.a_z_m_s2:+.2f} m/s², {turns}"
    if found.fault is not None:
        return
    yield "signs       a_z down, α and q nose up: kinematically consistent"
    yield "units       rad, rad/s, m/s²: kinematically consistent"
    yield f"elevator    dead time {1e3 * found.dead_time_s:.0f} ms, lag {1e3 * found.lag_s:.0f} ms"
    if isfinite(found.damping):
        hertz = found.omega_rad_s / tau
        yield f"short period {found.omega_rad_s:.2f} rad/s ({hertz:.2f} Hz), damping {found.damping:.2f}"
    else:
        yield "short period none: the simulator is statically unstable at this speed"
    yield f"numbers     {_with_errors(found.derivatives, found.std)}"
    if found.side:
        yield f"roll, yaw   {_with_errors(found.side, found.std)}"
    yield "            ±: half the 95 % interval, including motion that a linear model does not describe"
    yield f"takes       elevator{''.join(f', {name}' for name in found.takes)}"
    for name in found.lacks:
        yield f"does not take {name}: {_LACKS[name]}"
    yield from found.notes


def _with_errors(values: Mapping[str, float], std: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {with_half(value, NORMAL_95 * std[name])}" for name, value in values.items())


def _control(name: str, value: float) -> str:
    return f"{100.0 * value:.0f} %" if name == "throttle" else f"{degrees(value):+.2f} deg"
