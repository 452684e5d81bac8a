"""Findings about the instruments of an estimate, and notes that the user must know, one sentence each.

The findings hold for the estimate they come from. A contradiction refuses no estimate that uses the value
from the data. A contradicted sign of the elevator prevents use, because the fit does not show which sign is
wrong.
"""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.signals.trust import InstrumentFinding, Quantity
from advisor.oem.correlation import HIGH_CORRELATION
from advisor.oem.estimate import Estimate, InstrumentEstimate
from advisor.oem.identifiability import correlated
from advisor.oem.instrument_fit import CONTRADICTS, Identified
from advisor.oem.instruments import KNOWN_TO
from advisor.oem.known_instruments import InstrumentName, found_of
from advisor.oem.prepare import Prepared
from advisor.oem.solution import Solution
from advisor.words.quantities import NORMAL_95, symbol

_PLACES: dict[str, tuple[str, Quantity, str]] = {
    "servo_lag_s": ("elevator", "lag_s", "elevator: {{lag_s: {:.3f}}}"),
    "command_delay_s": ("elevator", "delay_s", "elevator: {{delay_s: {:.3f}}}"),
    "vane_arm_m": ("alpha", "arm_m", "alpha: {{vane_arm_m: {:.2f}}}"),
    "alpha_delay_s": ("alpha", "delay_s", ""),
    "accelerometer_arm_m": ("a_z", "arm_m", "accelerometer: {{arm_m: {:.2f}}}"),
}
"""Channel, quantity and aircraft-file line of each instrument parameter, by its name."""


def findings_of(estimate: Estimate, aircraft: Aircraft) -> tuple[InstrumentFinding, ...]:
    """Return the findings of an estimate about the instruments, including those that agree with the aircraft
    file.

    Parameters
    ----------
    estimate
        Estimate from one manoeuvre or from several manoeuvres together.
    aircraft
        Aircraft file that was used for the estimate.
    """
    return (*(_finding(x, aircraft) for x in estimate.instruments), *_sign(estimate))


def _finding(x: InstrumentEstimate, aircraft: Aircraft) -> InstrumentFinding:
    channel, quantity, _ = _PLACES[x.name]
    stated = aircraft.elevator.delay_s if x.name == "command_delay_s" else x.stated
    value, std = (x.value, x.std) if x.stated is None else (x.unstated_value, x.unstated_std)
    worth = x.contradicts or (x.stated is None and std < KNOWN_TO * abs(value))
    return InstrumentFinding(
        channel,
        quantity,
        stated,
        value,
        std,
        contradicts=x.contradicts,
        text=_text(x, stated, value, std),
        fix=line_of(x.name, value) if worth else "",
        used=x.contradicts or x.stated is None,
    )


def _text(x: InstrumentEstimate, stated: float | None, value: float, std: float) -> str:
    apart = value - (stated or 0.0)
    later = "later" if apart > 0.0 else "earlier"
    match x.name:
        case "servo_lag_s" if x.contradicts:
            return f"the surface responds {abs(apart):.2f} s {later} than elevator.lag_s says"
        case "servo_lag_s" if stated is not None:
            return f"{value_in_words(x.name, value, std)}, as elevator.lag_s says"
        case "command_delay_s" if x.contradicts and stated is not None:
            return f"the command acts {abs(apart):.3f} s {later} than elevator.delay_s says"
        case "vane_arm_m" if x.contradicts:
            return f"alpha reads like a vane {value:.2f} m ahead, and alpha.vane_arm_m says {stated:.2f} m"
        case _:
            return value_in_words(x.name, value, std)


def value_in_words(name: InstrumentName, value: float, std: float) -> str:
    """Return the value of an instrument with its 95 % interval, as the beginning of a sentence."""
    half = NORMAL_95 * std
    match name:
        case "servo_lag_s":
            return f"the servo's lag is {value:.3f} ± {half:.3f} s"
        case "command_delay_s":
            side = "before" if value < 0.0 else "after"
            return f"the command acts {abs(1e3 * value):.0f} ± {1e3 * half:.0f} ms {side} its stamps"
        case "vane_arm_m":
            place = f"{abs(value):.2f} ± {half:.2f} m {_side(value)} the centre of gravity"
            return f"alpha reads like a vane {place}"
        case "alpha_delay_s":
            side = "early" if value < 0.0 else "late"
            return f"alpha is {abs(1e3 * value):.0f} ± {1e3 * half:.0f} ms {side} relative to the motion"
        case "accelerometer_arm_m":
            place = f"{abs(value):.2f} ± {half:.2f} m {_side(value)} the centre of gravity"
            return f"the accelerometer reads as if it were {place}"
        case _:
            return (
                "the moment that does not change with air speed, such as the thrust's, equals"
                f" {np.degrees(value):+.1f} ± {np.degrees(half):.1f} deg of elevator"
            )


def _side(arm_m: float) -> str:
    """Return on which side of the centre of gravity an arm lies."""
    return "ahead of" if arm_m >= 0.0 else "behind"


def line_of(name: InstrumentName, value: float) -> str:
    """Return the line for the aircraft file; empty if the file has no key for the instrument."""
    return _PLACES[name][2].format(value) if name in _PLACES else ""


def _sign(estimate: Estimate) -> tuple[InstrumentFinding, ...]:
    """Return a finding if the elevator's stated sign turns the aircraft the wrong way; else none.

    The elevator is positive trailing edge down, so that M_δe is negative on every aircraft.
    """
    j = PARAMETERS.index("M_delta_e")
    value, std = float(estimate.theta[j]), float(estimate.std[j])
    if "M_delta_e" in estimate.not_identifiable or not value > CONTRADICTS * std:
        return ()
    return (
        InstrumentFinding(
            "elevator",
            "sign",
            1.0,
            -1.0,
            contradicts=True,
            text=f"the elevator's sign is wrong: M_delta_e comes out as {value:+.3g}, and it is negative on"
            " every aircraft",
            fix="turn the sign of every deflection in elevator.calibration (trailing edge down is positive)",
        ),
    )


N = len(PARAMETERS)
FOR_THE_FILE = " For the aircraft file: "
"""Words before the line for the aircraft file at the end of a note."""
NOTED_LAG_S = 0.05
NOTED_SCALE = 0.02


def notes(
    solution: Solution,
    prepared: Prepared,
    aircraft: Aircraft,
    identified: Sequence[Identified],
    *,
    best: Solution,
) -> tuple[str, ...]:
    """Return the notes on an estimate, one sentence each.

    Parameters
    ----------
    identified : instrument parameters that the data determine.
    best : the solution of the values: ``solution``, or filter error's.
    """
    sentences = [
        _outputs(solution, prepared),
        *(_instrument(x) for x in identified if _is_worth_saying(x)),
        _ridge(solution),
        _found_lag(aircraft),
        _airspeed(prepared),
        _scale(solution),
        _held(prepared),
        _edges(solution, prepared),
        _vane(aircraft),
        _weighed(solution, best),
        _correlated(solution),
        _missing(prepared),
    ]
    return tuple(sentence for sentence in sentences if sentence)


def _outputs(solution: Solution, prepared: Prepared) -> str:
    if not prepared.alpha_left_out:
        return ""
    why = prepared.alpha_left_out[0].upper() + prepared.alpha_left_out[1:]
    return (
        f"{why}. Estimated from {' and '.join(solution.assembly.rows[0])}, with alpha as an unmeasured state."
    )


def _ridge(solution: Solution) -> str:
    """Return a sentence about two lags that explain the record alike; empty for a posterior with one maximum.

    The sentence names the derivative that differs most. No sentence is needed where the linear interval of
    every derivative holds both lags.
    """
    rows = [PARAMETERS.index(x) for x in ("M_alpha", "M_q", "M_delta_e") if x not in solution.problem.fixed]
    if solution.alike is None or not rows:
        return ""
    std = np.sqrt(np.diag(solution.scattered))[rows]
    lag_s, theta = solution.alike[:, 0], solution.alike[:, 1:]
    apart = np.abs(theta[:, rows] - theta[0, rows]) / std
    far, which = np.unravel_index(int(np.argmax(apart)), apart.shape)
    if apart[far, which] <= NORMAL_95 or f"{lag_s[0]:.2f}" == f"{lag_s[far]:.2f}":
        return ""
    k = rows[which]
    return (
        f"Servo lags of {lag_s[0]:.2f} s and {lag_s[far]:.2f} s explain the record alike, with "
        f"{symbol(PARAMETERS[k])} of {theta[0, k]:.3g} and {theta[far, k]:.3g}. "
        "Set elevator.lag_s if it is known."
    )


def _is_worth_saying(identified: Identified) -> bool:
    """Return whether the data give an instrument value that differs from the file and from a sound
    instrument.
    """
    x, value = identified.instrument, identified.found
    if x.stated is not None or x.prior is None:
        return value.contradicts
    usual = 0.0 if x.name == "servo_lag_s" else x.prior.mean
    return x.name != "alpha_delay_s" and abs(value.value - usual) > CONTRADICTS * value.std


def _instrument(identified: Identified) -> str:
    """Return a sentence about one instrument, with the aircraft-file line for its value."""
    x = identified.found
    text = value_in_words(x.name, x.value, x.std)
    line = line_of(x.name, x.value) if x.std < KNOWN_TO * abs(x.value) else ""
    advice = f"{FOR_THE_FILE}{line}" if line else ""
    used = (
        ", by which the estimate lags the command"
        if x.name == "servo_lag_s"
        else "; the estimate allows for that"
    )
    return f"{text[0].upper()}{text[1:]}{used}.{advice}"


def _found_lag(aircraft: Aircraft) -> str:
    instruments = found_of(aircraft)
    lag_s = None if instruments is None else instruments.value("servo_lag_s")
    if aircraft.elevator.lag_s is not None or lag_s is None:
        return ""
    return f"The servo's lag of {lag_s:.3f} s is used, as estimated from all manoeuvres."


def _airspeed(prepared: Prepared) -> str:
    if prepared.airspeed_lag_s < NOTED_LAG_S:
        return ""
    return (
        f"The measured air speed lags the accelerometers by {prepared.airspeed_lag_s:.1f} s. Its changes"
        " within a manoeuvre are computed from the accelerometers."
    )


def _scale(solution: Solution) -> str:
    scale = float(solution.optimum.shared[6])
    if abs(scale) < NOTED_SCALE or len(solution.problem.records) == 1:
        return ""
    return (
        "Accelerations agree with the angle of attack if the true air speed differs by"
        f" {100.0 * scale:+.1f} % from the measured one. An angle of attack with a scale error of"
        f" {-100.0 * scale:+.1f} % would look the same. The fit of a_z allows for both errors; the"
        " derivatives refer to the measured air speed."
    )


def _held(prepared: Prepared) -> str:
    if not prepared.alpha_held:
        return ""
    return (
        f"The angle of attack has new values at {prepared.renewed_hz:.0f} Hz only; messages in between"
        " repeat the last one. The fit uses each value once."
    )


def _edges(solution: Solution, prepared: Prepared) -> str:
    pairs = zip(solution.problem.records, prepared.problem.records, strict=True)
    steps = sum(len(used.elevator.t) - len(given.elevator.t) for used, given in pairs) // 2
    if steps == 0:
        return ""
    return f"The times of {steps} elevator steps, each between two samples of the command, are estimated too."


def _vane(aircraft: Aircraft) -> str:
    arm = aircraft.alpha.vane_arm_m
    return f"Angle of attack was moved {arm:g} m from the vane to the centre of gravity." if arm else ""


def _weighed(solution: Solution, best: Solution) -> str:
    if best.theta is solution.theta or all(
        colour.memory == 0.0 for colour in solution.noise.colours.values()
    ):
        return ""
    memories = ", ".join(
        f"{output} {colour.memory:.2f}" for output, colour in solution.noise.colours.items() if colour.memory
    )
    return (
        f"The noise is coloured (correlation of neighbouring samples: {memories}). Values and errors are"
        " those of generalised least squares; the cost is output error's."
    )


def _correlated(solution: Solution) -> str:
    pairs = [f"{symbol(a)} and {symbol(b)}" for a, b, _ in correlated(solution.covariance_cr[:N, :N])]
    if not pairs:
        return ""
    return (
        f"Errors are correlated above {HIGH_CORRELATION:g}: {', '.join(pairs)}. This input determines their"
        " combination better than each alone."
    )


def _missing(prepared: Prepared) -> str:
    if "a_z" not in prepared.missing:
        return ""
    return (
        "The fit lacks the vertical acceleration, which needs a_z and air speed. Z_alpha, Z_q, Z_delta_e and"
        " M_q depend on the delay and the arm of the angle of attack. Give alpha.vane_arm_m for a vane."
    )
