"""What the user must know about the numbers, one sentence each."""

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.flight.messages import FloatArray
from advisor.oem.identifiability import HIGH_CORRELATION, SUPPOSED_LAG_S, correlated
from advisor.oem.missing import in_words, price
from advisor.oem.prepare import Prepared
from advisor.oem.servo_lag import Lag
from advisor.oem.solution import Solution

N = len(PARAMETERS)
NOTED_LAG_S = 0.05
NOTED_SCALE = 0.02


def notes(
    solution: Solution,
    prepared: Prepared,
    aircraft: Aircraft,
    lag: Lag | None,
    lagged: FloatArray | None,
    *,
    best: Solution,
    priced: bool,
) -> tuple[str, ...]:
    """Collect the sentences.

    Parameters
    ----------
    lag : result of the search for a servo lag, when one was made.
    lagged : (8,) the estimate under ``SUPPOSED_LAG_S`` of servo lag, when the servo is unknown.
    best : the solution the values are taken from, ``solution`` or the efficient one.
    priced : say in numbers what missing channels cost.
    """
    sentences = [
        _servo(solution, lag, lagged),
        _airspeed(prepared),
        _scale(solution),
        _held(prepared),
        _edges(solution, prepared),
        _offset(solution, prepared),
        _vane(aircraft),
        _weighed(solution, best),
        _correlated(solution),
        *_missing(solution, prepared, priced),
    ]
    return tuple(sentence for sentence in sentences if sentence)


def _servo(solution: Solution, lag: Lag | None, lagged: FloatArray | None) -> str:
    if lag is not None and lag.lag_s > 0.0:
        return (
            f"Servo dynamics unknown (elevator.lag_s not set): a lag of {lag.lag_s:.3f} ± {lag.std_s:.3f} s"
            " was estimated together with the derivatives and applied; a pure delay would look much the same."
        )
    if lagged is None:
        return ""
    changes = []
    for name in ("M_alpha", "M_delta_e"):
        j = PARAMETERS.index(name)
        if solution.theta[j] != 0.0:
            changes.append(f"{name} by {100.0 * (lagged[j] / solution.theta[j] - 1.0):+.0f} %")
    return (
        f"Servo dynamics unknown (elevator.lag_s is not set): a lag of {SUPPOSED_LAG_S:g} s, if there is one,"
        f" changes {' and '.join(changes)}."
    )


def _airspeed(prepared: Prepared) -> str:
    if prepared.airspeed_lag_s < NOTED_LAG_S:
        return ""
    return (
        f"The air speed reads {prepared.airspeed_lag_s:.1f} s late against the accelerometers; its course"
        " within a manoeuvre is taken from them."
    )


def _scale(solution: Solution) -> str:
    scale = float(solution.optimum.shared[6])
    if abs(scale) < NOTED_SCALE or len(solution.problem.records) == 1:
        return ""
    return (
        f"Accelerations agree with angle of attack if the true air speed is {100.0 * scale:+.1f} % from the"
        " measured (or angle of attack is that much off, the other way); this is allowed for in a_z, not in"
        " the speed the derivatives are given at."
    )


def _held(prepared: Prepared) -> str:
    if not prepared.alpha_held:
        return ""
    return (
        f"Angle of attack is renewed at {prepared.renewed_hz:.0f} Hz only and repeated under fresh stamps"
        " between; it is used at that rate."
    )


def _edges(solution: Solution, prepared: Prepared) -> str:
    pairs = zip(solution.problem.records, prepared.problem.records, strict=True)
    steps = sum(len(used.elevator.t) - len(given.elevator.t) for used, given in pairs) // 2
    if steps == 0:
        return ""
    return f"When {steps} elevator steps happened between two samples of the command was estimated, too."


def _offset(solution: Solution, prepared: Prepared) -> str:
    later = solution.problem.servo.delay_s - prepared.problem.servo.delay_s
    if later == 0.0:
        return ""
    reading = "held" if solution.problem.records[0].held else "linear"
    return (
        f"The command, {reading} between its stamps, acts {1e3 * later:+.1f} ms from them; this was"
        " estimated, too."
    )


def _vane(aircraft: Aircraft) -> str:
    arm = aircraft.alpha.vane_arm_m
    return f"Angle of attack was moved {arm:g} m from the vane to the centre of gravity." if arm else ""


def _weighed(solution: Solution, best: Solution) -> str:
    if best is solution:
        return ""
    memories = ", ".join(
        f"{output} {colour.memory:.2f}" for output, colour in solution.noise.colours.items() if colour.memory
    )
    return (
        f"The noise remembers (from sample to sample: {memories}) and is nothing but noise: values and errors"
        " are those of generalised least squares, which weighs it as it is; the cost stays output error's."
    )


def _correlated(solution: Solution) -> str:
    pairs = [f"{a} and {b}" for a, b, _ in correlated(solution.covariance_cr[:N, :N])]
    if not pairs:
        return ""
    return (
        f"Errors are correlated above {HIGH_CORRELATION:g}: {', '.join(pairs)}; this input tells them better"
        " together than each alone."
    )


def _missing(solution: Solution, prepared: Prepared, priced: bool) -> list[str]:
    sentences = []
    if "a_z" in prepared.missing:
        sentences.append(
            "No vertical acceleration was used (it takes a_z and air speed): Z_alpha, Z_q and Z_delta_e rest"
            " on angle of attack alone, and a late or scaled angle of attack goes into them unseen."
            + in_words(price(solution, "a_z") if priced else None)
        )
    if "theta" in prepared.missing:
        sentences.append(
            "No pitch attitude was used: a bias of the pitch rate cannot be told from Z_0 and M_0."
            + in_words(price(solution, "theta") if priced else None)
        )
    return sentences
