"""Sealed cases from flights of ArduPlane: what is withheld, the log, the aircraft file, and the truth.

A flight tests both axes, so it gives two cases: one of pitch, and one of roll and yaw with the same log.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.sealed.generator import truth
from benchmarks.sealed.tlog import Timed, packed
from benchmarks.sealed.world import messages_of
from sim.sealed.cases import SealedCase

from .airframe import FULL_RAD, Airframe, draw_airframe
from .plan import OUTPUTS, inputs_of, script
from .simulator import FlightError, Heard, fly, is_here

KINDS = ("none", "parameters", "lag", "none", "delay", "air")
"""What is withheld, in turns: a third of the flights have nothing withheld."""
AXES = ("pitch", "lateral")
MAIN = {
    "pitch": ("Z_alpha", "M_alpha", "M_q", "M_delta_e"),
    "lateral": ("L_beta", "L_p", "L_delta_a", "N_beta", "N_r", "N_delta_r"),
}
"""Derivatives that a file may state wrongly."""
CONTROLS = {"pitch": ("elevator",), "lateral": ("aileron", "rudder")}
TRUE_OVER_READ = 1.05
"""True air speed over VFR_HUD's, at the height of the flights, by the ground speed in still air."""
HEIGHT_M = 90.0
"""Height of the flights above home, m."""
KEPT = Path("build") / "arduplane"
"""Folder of the logs that were flown, which are not flown again."""
_FLYING_M_S = 12.0
"""Least air speed in flight, m/s."""
_ATTEMPTS = 3


@dataclass(frozen=True)
class Withheld:
    """What the aircraft file of a flight does not know."""

    kind: str
    factors: Mapping[str, float] = field(default_factory=dict)
    """Stated over true value of each wrong derivative."""
    lag_s: float = 0.14
    """Lag of the servos in the flight, s."""
    stated_lag_s: float = 0.14
    delay_s: float = 0.0
    """Time by which every command acts after its stamp, s."""
    gust_m_s: float = 0.0
    """Turbulence of the simulator (SIM_WIND_TURB), m/s; the wind's speed scales with it."""
    wind_m_s: float = 0.0
    wind_from_deg: float = 0.0

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters of the simulator."""
        return {
            "SIM_SERVO_SPEED": self.lag_s, "SIM_WIND_SPD": self.wind_m_s, "SIM_WIND_TURB": self.gust_m_s,
            "SIM_WIND_DIR": self.wind_from_deg,
        }  # fmt: skip


def draw_withheld(kind: str, rng: np.random.Generator) -> Withheld:
    """Draw what is withheld from the aircraft file.

    Raises
    ------
    ValueError
        There is no such kind.
    """
    lag_s = float(rng.choice([0.04, 0.08, 0.14]))
    if kind == "none":
        return Withheld(kind, lag_s=lag_s, stated_lag_s=lag_s)
    if kind == "parameters":
        factors = {}
        for names in MAIN.values():
            for name in rng.choice(names, int(rng.integers(1, 3)), replace=False):
                factors[str(name)] = float(rng.choice([rng.uniform(0.7, 0.85), rng.uniform(1.2, 1.4)]))
        return Withheld(kind, factors, lag_s, lag_s)
    if kind == "lag":
        return Withheld(kind, lag_s=lag_s + float(rng.uniform(0.04, 0.1)), stated_lag_s=lag_s)
    if kind == "delay":
        return Withheld(kind, lag_s=lag_s, stated_lag_s=lag_s, delay_s=float(rng.uniform(0.06, 0.12)))
    if kind == "air":
        wind = float(rng.uniform(2.0, 6.0)), float(rng.uniform(0.0, 360.0))
        return Withheld(kind, {}, lag_s, lag_s, 0.0, float(rng.uniform(2.0, 6.0)), *wind)
    raise ValueError(f"{kind}: there is no such kind; known are {', '.join(sorted(set(KINDS)))}")


def cases(count: int, seed: int, only: str | None = None) -> Iterator[SealedCase]:
    """Yield ``count`` cases, two a flight, or none without the simulator next to the checkout.

    Raises
    ------
    ValueError
        There is no such kind.
    """
    if only is not None and only not in (*KINDS, "outside", "one"):
        raise ValueError(f"{only}: there is no such kind; known are {', '.join(sorted(set(KINDS)))}")
    kinds = [kind for kind in KINDS if only in (None, kind) or (only == "one" and kind in _EFFECTS)]
    if not is_here() or not kinds:
        return
    made = 0
    for number in range(count):
        kind = kinds[number % len(kinds)]
        for case in flight_cases(kind, seed, number):
            if made < count:
                made += 1
                yield case
        if made >= count:
            return


_EFFECTS = ("lag", "delay", "air")


def flight_cases(kind: str, seed: int, number: int) -> Iterator[SealedCase]:
    """Fly one flight, or read it where it is kept, and yield its case of each axis."""
    name = f"{seed}-{kind}-{number:04d}"
    for attempt in range(_ATTEMPTS):
        rng = np.random.default_rng([seed, number, attempt])
        airframe, withheld = draw_airframe(rng), draw_withheld(kind, rng)
        inputs = inputs_of(airframe, rng)
        read_m_s = airframe.speed_m_s / TRUE_OVER_READ
        lua = script(inputs, round(1000.0 + 1000.0 * airframe.throttle), HEIGHT_M, read_m_s)
        try:
            flown = partial(fly, airframe.coefficients, withheld.parameters, lua)
            timed = kept(f"{name}-{attempt}", flown)
        except FlightError:
            if attempt == _ATTEMPTS - 1:
                raise
            continue
        read_m_s = read_speed(timed)
        log, file = log_of(timed, withheld.delay_s), aircraft_file(airframe, withheld, read_m_s)
        for axis in AXES:
            true = truth_of(axis, withheld, airframe, read_m_s)
            yield SealedCase(f"{number:04d}-{axis}", true, log, file)
        return


def kept(name: str, flown: Callable[[], Heard]) -> list[Timed]:
    """Return the messages of a flight that was flown before, or fly it and keep its log."""
    log = KEPT / f"{name}.tlog"
    if not log.is_file():
        heard = flown()
        KEPT.mkdir(parents=True, exist_ok=True)
        part = log.with_suffix(".part")
        part.write_bytes(packed(heard.messages))
        part.replace(log)
    return messages_of(log.read_bytes())


def log_of(timed: list[Timed], delay_s: float) -> bytes:
    """Return the messages as a tlog, with the stamps of the servo outputs earlier by ``delay_s``."""
    for _, message in timed:
        if message.get_type() == "SERVO_OUTPUT_RAW" and delay_s:
            message.time_usec = max(message.time_usec - round(delay_s * 1e6), 0)
    return packed(timed)


def read_speed(timed: list[Timed]) -> float:
    """Return the mean air speed that the autopilot showed in MANUAL, m/s."""
    manual, speeds = False, []
    for _, message in timed:
        if message.get_type() == "HEARTBEAT":
            manual = message.custom_mode == 0
        elif message.get_type() == "VFR_HUD" and manual and message.airspeed > _FLYING_M_S:
            speeds.append(message.airspeed)
    return float(np.mean(speeds))


def aircraft_file(airframe: Airframe, withheld: Withheld, read_m_s: float) -> dict[str, Any]:
    """Return what the crew knows: the simulator's numbers at the flown speed, with the wrong ones in it."""
    full = round(float(np.degrees(FULL_RAD)), 3)
    model = airframe.derivatives(TRUE_OVER_READ * read_m_s)
    stated = {name: value * withheld.factors.get(name, 1.0) for name, value in model.items()}
    # A file with a wrong M_α or Z_α is still in trim where the aircraft is.
    stated["Z_0"] *= withheld.factors.get("Z_alpha", 1.0)
    stated["M_0"] *= withheld.factors.get("M_alpha", 1.0)
    lag_s = withheld.stated_lag_s

    def control(output: int) -> dict[str, Any]:
        calibration = [[1000, full], [1500, 0.0], [2000, -full]]
        return {"output": output, "calibration": calibration, "lag_s": lag_s, "delay_s": 0.0}

    return {
        "name": "arduplane",
        **{name: control(output) for name, output in OUTPUTS.items()},
        "accelerometer": {"arm_m": 0.0},
        "reference_airspeed_m_s": round(read_m_s, 4),
        "model": {name: float(f"{value:.6g}") + 0.0 for name, value in stated.items()},
    }


def truth_of(axis: str, withheld: Withheld, airframe: Airframe, read_m_s: float) -> dict[str, Any]:
    """Return what is true of one axis of a flight."""
    wrong = {name: f for name, f in withheld.factors.items() if name in MAIN[axis]}
    kind = "one" if withheld.kind in _EFFECTS else withheld.kind
    lateral = axis == "lateral"
    sizes = {
        "lag": ("actuator_lag", "input", {"lag_s": withheld.lag_s - withheld.stated_lag_s}),
        "delay": ("transport_delay", "input", {"delay_s": withheld.delay_s}),
        "air": ("turbulence", "air", {}),
    }
    effects = []
    if kind == "one":
        name, block, size = sizes[withheld.kind]
        acts = CONTROLS[axis] if lateral and block == "input" else ("",)
        names = [f"{c}_{name}" if c else ("side_gusts" if lateral else name) for c in acts]
        effects = [(each, acts[k] or block, size) for k, each in enumerate(names)]
        if lateral and withheld.kind == "delay":
            # All servo outputs have one stamp, so their delay is one cause.
            effects.append(("common_transport_delay", "input", size))
    return truth(
        kind, "autopilot", effects, [], axis=axis, factors=wrong, mass_kg=airframe.mass_kg,
        derivatives=airframe.derivatives(TRUE_OVER_READ * read_m_s), servo_lag_s=withheld.lag_s,
        gust_m_s=withheld.gust_m_s,
    )  # fmt: skip
