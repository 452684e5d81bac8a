"""What the simulator believes about an aircraft, nearly right or plainly wrong."""

from dataclasses import replace

import numpy as np

from .maneuvers import Plan
from .telemetry import Noise
from .trim import LinearModel
from .visibility import NAMED_RATIO


def believed_model(
    true: LinearModel,
    plan: Plan,
    trim: tuple[float, float],
    wrong: bool,
    noise: Noise,
    rng: np.random.Generator,
) -> LinearModel:
    """What the simulator believes: 1-2 % off, or plainly wrong in two to four derivatives; always in trim."""
    names = ["Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e"]
    while True:
        factors = {name: 1.0 + float(rng.choice([-1.0, 1.0]) * rng.uniform(0.0, 0.02)) for name in names}
        if wrong:
            chosen = rng.choice(
                ["Z_alpha", "M_alpha", "M_q", "M_delta_e"], int(rng.integers(2, 5)), replace=False
            )
            for name in chosen:
                factors[str(name)] = 1.0 + float(rng.choice([-1.0, 1.0]) * rng.uniform(0.15, 0.40))
        model = replace(true, **{name: getattr(true, name) * factor for name, factor in factors.items()})
        alpha, elevator = trim
        model = replace(
            model,
            Z_0=-model.Z_alpha * alpha - model.Z_delta_e * elevator,
            M_0=-model.M_alpha * alpha - model.M_delta_e * elevator,
        )
        one, other = true.response(plan.offset, plan.step), model.response(plan.offset, plan.step)
        seen = max(float(np.std(one[k] - other[k])) / std for k, std in enumerate((noise.alpha, noise.q)))
        if not wrong or seen >= NAMED_RATIO:
            return model
