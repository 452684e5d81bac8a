"""Sealed cases of flights by hand: what is withheld, the log, the aircraft file, and the truth."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from benchmarks.arduplane_generator.cases import AXES, CONTROLS, MAIN
from benchmarks.at_once.body import FLEET, Body, draw_body
from benchmarks.at_once.telemetry import OUTPUTS, tlog_of
from benchmarks.sealed.generator import truth
from benchmarks.sealed.tlog import MANUAL
from benchmarks.sealed.world import in_the_world
from sim.sealed.cases import SealedCase

from .flight import CONTROLS as SURFACES
from .flight import Servos, fly, inputs_of

KINDS = ("none", "parameters", "lag", "none", "delay", "air", "none", "parameters", "rate", "backlash")
"""What is withheld, in turns: three of ten flights have nothing withheld."""
_EFFECTS = ("lag", "delay", "air", "rate", "backlash")
_UPSET_RAD = 1.0
"""Bank or pitch angle at which a flight is drawn anew, rad."""


@dataclass(frozen=True)
class Withheld:
    """What the aircraft file of a flight does not know."""

    kind: str
    control: str
    """Surface whose servo differs; all surfaces for a delay."""
    factors: Mapping[str, float] = field(default_factory=dict)
    """Stated over true value of each wrong derivative."""
    lag_s: float = 0.04
    """Stated lag of the servos, s."""
    more_s: float = 0.0
    """Lag of the surface's servo beyond the stated one, or delay of all commands, s."""
    rate_rad_s: float = 1e3
    play_rad: float = 0.0
    gust_share: float = 0.0
    """Gusts over the air speed."""

    @property
    def servos(self) -> Servos:
        """Servos of the flight."""
        lags = dict.fromkeys(SURFACES, self.lag_s)
        if self.kind == "lag":
            lags[self.control] += self.more_s
        return Servos(
            lags, {self.control: self.rate_rad_s}, {self.control: self.play_rad},
            self.more_s if self.kind == "delay" else 0.0,
        )  # fmt: skip

    def effect(self, axis: str) -> tuple[str, str, dict[str, float]]:
        """Return name, block and sizes of the effect of a flight."""
        of = "" if axis == "pitch" else f"{self.control}_"
        block = "input" if axis == "pitch" else self.control
        width = {"half_width_rad": 0.5 * self.play_rad}
        return {
            "lag": (f"{of}actuator_lag", block, {"lag_s": self.more_s}),
            "delay": ("transport_delay" if axis == "pitch" else "common_transport_delay", "input",
                      {"delay_s": self.more_s}),
            "rate": (f"{of}actuator_rate_limit", block, {"rate_rad_s": self.rate_rad_s}),
            "backlash": (f"{of}actuator_backlash", block, width),
            "air": ("turbulence" if axis == "pitch" else "side_gusts", "air", {}),
        }[self.kind]  # fmt: skip


def draw_withheld(kind: str, axis: str, rng: np.random.Generator) -> Withheld:
    """Draw what is withheld from the aircraft file."""
    base = Withheld(kind, str(rng.choice(CONTROLS[axis])), lag_s=float(rng.uniform(0.03, 0.06)))
    if kind == "parameters":
        names = rng.choice(MAIN[axis], 2, replace=False)
        factors = {str(n): float(rng.choice([rng.uniform(0.65, 0.8), rng.uniform(1.25, 1.4)])) for n in names}
        return replace(base, factors=factors)
    sizes: dict[str, dict[str, float]] = {
        "none": {}, "lag": {"more_s": rng.uniform(0.05, 0.1)}, "delay": {"more_s": rng.uniform(0.05, 0.1)},
        "rate": {"rate_rad_s": np.radians(rng.uniform(20.0, 40.0))},
        "backlash": {"play_rad": np.radians(rng.uniform(1.0, 2.0))},
        "air": {"gust_share": rng.uniform(0.02, 0.04)},
    }  # fmt: skip
    return replace(base, **{name: float(value) for name, value in sizes[kind].items()})  # type: ignore[arg-type]


def cases(
    count: int, seed: int, only: str | None = None, natural_share: float = 0.0, noise_factor: float = 0.0
) -> Iterator[SealedCase]:
    """Yield ``count`` cases, of pitch and of roll and yaw in turns.

    Natural numbers act in every flight with a ``natural_share`` of 1. The noise is one size.
    """
    kinds = [k for k in KINDS if only in (None, k) or (only == "one" and k in _EFFECTS)]
    for number in range(count if kinds else 0):
        axis, kind = AXES[number % 2], kinds[(number // 2) % len(kinds)]
        rng = np.random.default_rng([seed, number])
        case = _flight(f"{number:04d}-{axis}", axis, kind, rng)
        yield in_the_world(case, seed) if rng.random() < natural_share else case


def _flight(name: str, axis: str, kind: str, rng: np.random.Generator) -> SealedCase:
    """Draw flights until one stays near level flight, and return its case."""
    while True:
        body, withheld = draw_body(rng, int(rng.integers(len(FLEET)))), draw_withheld(kind, axis, rng)
        # Calm air moves a little.
        share = withheld.gust_share or float(rng.choice([0.0, 0.0, rng.uniform(0.002, 0.006)]))
        inputs = inputs_of(body, axis, rng)
        recorded = fly(body, inputs, withheld.servos, share * body.speed, rng)
        if np.all(np.abs(recorded.state[:, 6:8]) < _UPSET_RAD):
            break
    log = tlog_of(recorded, body, bool(rng.random() < 0.5), rng, MANUAL)
    told = "one" if kind in _EFFECTS else kind
    effects = [withheld.effect(axis)] if told == "one" else []
    true = truth(
        told, "by hand", effects, [], axis=axis, factors=dict(withheld.factors), gust_m_s=share * body.speed,
        derivatives=body.derivatives(body.speed), aircraft=body.pitching.name,
        also_true=["turbulence" if axis == "pitch" else "side_gusts"] if share else [],
        inputs=[(SURFACES[i.control], i.begin_s, i.end_s) for i in inputs],
    )  # fmt: skip
    return SealedCase(name, true, log, aircraft_file(body, withheld))


def aircraft_file(body: Body, withheld: Withheld) -> dict[str, Any]:
    """Return what the crew knows: the derivatives with the wrong ones in it, and the servos of the file."""
    d = body.derivatives(body.speed)
    stated = {name: value * withheld.factors.get(name, 1.0) for name, value in d.items()}
    # A file with a wrong M_α or M_δe is still in trim where the aircraft is.
    for of in ("Z", "M"):
        stated[f"{of}_0"] = -(stated[f"{of}_alpha"] * body.alpha + stated[f"{of}_delta_e"] * body.elevator)
    read = body.speed * float(np.sqrt(body.density / 1.225))
    return {
        "name": "by hand",
        **{
            name: {
                "output": output,
                "calibration": [[us, -0.0625 * (us - 1500)] for us in (1100, 1500, 1900)],
                "lag_s": round(withheld.lag_s, 4),
                "delay_s": 0.0,
            }
            for name, output in zip(SURFACES, OUTPUTS, strict=True)
        },
        "accelerometer": {"arm_m": 0.0},
        "reference_airspeed_m_s": round(read, 3),
        "model": {name: float(f"{value:.6g}") for name, value in stated.items()},
    }
