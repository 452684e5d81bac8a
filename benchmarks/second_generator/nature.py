"""What a flight has by nature: late command, filters, an autopilot's own alpha, indicated air speed.

A third of the flights have it, and none of it is a gap.
"""

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.sealed.tlog import Stream

from .kernel import Floats
from .motion import density
from .sensors import first_order, second_order

SHARE = 1.0 / 3.0
SEA_LEVEL_DENSITY = 1.225  # kg/m³
RENEWED = 20.0  # Hz at which an autopilot renews its angle of attack
USUAL_CUTOFF = 20.0  # Hz of an autopilot's filters of gyro and accelerometers
OF_A_VANE = frozenset({"alpha_lag", "alpha_scale", "alpha_bias", "alpha_vane_offset", "alpha_skew"})


@dataclass(frozen=True)
class Nature:
    """Nuisances of one flight; the default has none."""

    command_late: float = 0.0
    """Time [s] by which the command acts after its stamp."""
    cutoff: float = 0.0
    """Cut-off [Hz] of the filters of gyro and accelerometers; 0 without filters."""
    stated: bool = False
    """Whether the parameters state the filters."""
    alpha_lag: float = 0.0
    """Lag [s] of an angle of attack that the autopilot computes; 0 for a vane."""
    indicated: float = 1.0
    """Indicated over true air speed."""

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters of the autopilot that state the filters."""
        names = ("INS_GYRO_FILTER", "INS_ACCEL_FILTER") if self.stated and self.cutoff > 0.0 else ()
        return dict.fromkeys(names, self.cutoff)

    def shown(self, observed: dict[str, Floats], step: float) -> dict[str, Floats]:
        """Return the channels as the autopilot shows them, on the time grid."""
        true = observed["airspeed"]
        out = dict(
            observed, airspeed=self.indicated * true, groundspeed=np.sqrt(true**2 - observed["climb"] ** 2)
        )
        if self.alpha_lag > 0.0:
            path = np.arcsin(np.clip(observed["climb"] / observed["airspeed"], -1.0, 1.0))
            out["alpha"] = first_order(observed["theta"] - path, self.alpha_lag, step)
        if self.cutoff > 0.0:
            for name in ("q", "a_x", "a_z"):
                out[name] = second_order(out[name], 2.0 * np.pi * self.cutoff, np.sqrt(0.5), step)
        return out

    def sent(self, streams: dict[str, Stream]) -> dict[str, Stream]:
        """Return the streams with the command's stamps, and with the staircase of a computed angle."""
        servo = streams["servo"]
        out = {**streams, "servo": replace(servo, stamps=np.maximum(servo.stamps - self.command_late, 0.0))}
        if self.alpha_lag > 0.0:
            alpha = streams["alpha"]
            _, first, which = np.unique(
                np.floor(alpha.stamps * RENEWED), return_index=True, return_inverse=True
            )
            out["alpha"] = Stream(alpha.stamps, {"alpha": alpha.channels["alpha"][first[which]]})
        return out


def in_the_world(nature: Nature) -> Nature:
    """Return the nuisances of a flight in which filters always act."""
    return replace(nature, cutoff=nature.cutoff or USUAL_CUTOFF)


def draw_nature(rng: np.random.Generator, names: tuple[str, ...], height: float, share: float) -> Nature:
    """Draw the nuisances of a flight with some effects, at a height [m] above sea level.

    An air speed is indicated in every flight.
    """
    indicated = float(np.sqrt(density(height) / SEA_LEVEL_DENSITY))
    if rng.random() >= share:
        return Nature(indicated=indicated)
    computed = not OF_A_VANE & set(names) and bool(rng.random() < 0.5)
    return Nature(
        command_late=float(rng.uniform(-0.006, 0.010)),
        cutoff=float(rng.choice([0.0, 15.0, 20.0, 30.0])),
        stated=bool(rng.random() < 0.5),
        alpha_lag=float(rng.uniform(0.02, 0.09)) if computed else 0.0,
        indicated=indicated,
    )
