"""The force equation: nonlinear and unsteady lift, mass, ice, the ground."""

from dataclasses import replace

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.bent import bent
from advisor.gap.candidates.between import divide, ramps_and_steps, steps_in
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import DERIVATIVES, HEIGHT, INDEX

BLOCK = "force_equation"
_DECAYS_M = (0.1, 50.0)
"""Range of the height over which ground effect decays, m: from a fraction of a small span to more than a
large one."""
_ICED = ("Z_alpha", "Z_delta_e", "M_alpha", "M_delta_e")
CURVED_LIFT = Variant(
    "nonlinear_lift", BLOCK, ("Z_alpha2", "Z_alpha3"), ((0.0, 0.0),), (0.5, 5.0),
    ((-500.0, 500.0), (-1e4, 1e4)), 0.0, entries=("Z_alpha2", "Z_alpha3"),
)  # fmt: skip


_FORCES, _MOMENTS = DERIVATIVES[:3], DERIVATIVES[3:]
_MASS_AND_INERTIA = Variant(
    "mass_change", BLOCK, ("step", "inertia"), ((0.0, 0.0),), (0.005, 0.005), ((-0.9, 3.0), (-0.9, 3.0)), 0.01
)  # fmt: skip
_UNSTEADY = Variant(
    "unsteady_lift", BLOCK, ("share", "lag_s"), ((0.1, 0.1), (0.3, 0.4)), (0.005, 0.01),
    ((0.0, 0.95), (0.01, 3.0)), 0.01, entries=("lift_share", "lift_lag_s"),
)  # fmt: skip


def _with_moment(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Let the pitching moment build up with the lift, as on a wing without tail."""
    p[:, INDEX["lift_share"]] += values[0]
    p[:, INDEX["lift_lag_s"]] += values[1]
    p[:, INDEX["moment_share"]] += values[0]


_UNSTEADY_WITH_MOMENT = replace(_UNSTEADY, apply_with=_with_moment, fixed={"with_moment": 1.0})


def _powers(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set the powers of the air speed of the moments and of the lift; the simulation's moments include the
    lift's."""
    of_moments, of_lift = values
    p[:, INDEX["speed_power"]] += of_lift
    p[:, INDEX["moment_power"]] += of_moments - of_lift


def variants(flights: PreparedManeuvers) -> list[Variant]:
    """Return the effects of the block; those between manoeuvres depend on how many were flown."""
    return [
        bent(CURVED_LIFT, flights),
        replace(_UNSTEADY, likewise=(_UNSTEADY_WITH_MOMENT,)),
        *_stall(flights),
        *_mass(flights),
        *_icing(flights),
        # Mach number, elastic wings or a slipstream: forces grow with another power of the speed than V².
        Variant(
            "airspeed_variation", BLOCK, ("exponent",), ((0.0,),), (0.02,), ((-6.0, 6.0),), 0.1,
            entries=("speed_power",), needs=frozenset({"airspeed"}),
        ),
        # A tail in the wake of the wing or of a propeller: moments grow with another power than the lift.
        Variant(
            "airspeed_variation", BLOCK, ("exponent_M", "exponent"), ((0.0, 0.0),), (0.02, 0.02),
            ((-6.0, 6.0), (-6.0, 6.0)), 0.1, apply_with=_powers, needs=frozenset({"airspeed"}),
        ),
        # Near the ground all lift grows by a share, or the trim alone changes.
        *(
            Variant(
                "ground_effect", BLOCK, (lift, "M_h", "scale_m"),
                tuple((0.0, 0.0, scale) for scale in _heights_of_decay(flights)), (0.02, 0.2, 0.1),
                (bounds, (-500.0, 500.0), _DECAYS_M), 0.0, entries=(lift, "M_h", "scale_m"),
                needs=frozenset({"height"}), places=("scale_m",),
            )
            for lift, bounds in (("lift_h", (-0.9, 3.0)), ("Z_h", (-50.0, 50.0)))
        ),
    ]  # fmt: skip


def _heights_of_decay(flights: PreparedManeuvers) -> list[float]:
    """Return two heights in m over which ground effect may decay: a fifth and two thirds of the height
    flown."""
    if "height" not in flights.has:
        return []
    flown = float(np.median([np.median(f.slow[HEIGHT]) for f in flights.flights]))
    return [float(np.clip(share * flown, *_DECAYS_M)) for share in (0.2, 0.67)]


def _mass(flights: PreparedManeuvers) -> list[Variant]:
    """Return a change of mass with equal change of inertia; a step also has an inertia of its own as
    alternative.

    Mass far from the centre of gravity adds more inertia than mass near it.
    """
    together = ramps_and_steps("mass_change", BLOCK, flights, divide(*DERIVATIVES))
    inertia = {
        variant.fixed["at_s"]: replace(variant, starts=(), likewise=(), carried=lambda v: (v[0], v[0]))
        for variant in steps_in(flights, _MASS_AND_INERTIA, _divided_separately)
    }
    return [
        replace(v, likewise=(*v.likewise, inertia[v.fixed["at_s"]])) if "at_s" in v.fixed else v
        for v in together
    ]


def _divided_separately(p: FloatArray, values: Values, share: FloatArray) -> None:
    """Divide forces by the growth of mass and moments by the growth of inertia, in manoeuvres that have the
    change."""
    for change, growth in zip((divide(*_FORCES), divide(*_MOMENTS)), values, strict=True):
        change(p, growth * share)


def _stall(flights: PreparedManeuvers) -> list[Variant]:
    """Return flow separation about an angle of attack (Kirchhoff's flow): a kink, unlike any parabola."""
    if "alpha" not in flights.channels:
        return []
    trim = float(np.median([f.alpha_trim for f in flights.flights]))
    top = max(float(np.max(f.outputs["alpha"].y)) for f in flights.flights)
    return [
        Variant(
            "nonlinear_lift",
            BLOCK,
            ("stall_rad", "sharpness"),
            ((trim + 0.5 * (top - trim), 40.0), (top, 40.0), (top + 0.03, 20.0)),
            (0.002, 0.5),
            ((0.0, 1.0), (2.0, 200.0)),
            0.0,
            entries=("stall_rad", "stall_sharpness"),
            # A wing that is already stalled where the aircraft is trimmed.
            start_at_prior=(0.65 * trim, 25.0) if trim > 0.0 else None,
        )
    ]  # fmt: skip


def _icing(flights: PreparedManeuvers) -> list[Variant]:
    """Return a loss of lift slope and control power at once, each by its own share, between two
    manoeuvres."""
    if len(flights) < 3:
        return []

    def weaken(p: FloatArray, values: Values, share: FloatArray) -> None:
        for name, value in zip(_ICED, values, strict=True):
            p[:, INDEX[name]] *= 1.0 + value * share

    bounds = ((-0.9, 0.02), (-0.9, 0.3), (-0.9, 0.3), (-0.9, 0.02))
    one = Variant("icing", BLOCK, _ICED, ((0.0,) * 4,), (0.005,) * 4, bounds, 0.02, one_sided=True)
    return steps_in(flights, one, weaken)
