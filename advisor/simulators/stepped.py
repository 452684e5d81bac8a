"""A simulator from an environment that can only step: Gymnasium, MuJoCo, Isaac, or a custom loop.

    from advisor.simulators.stepped import Stepped

    class Mine:                      # an environment as it is
        def reset(self, speed, height, alpha, theta): ...
        def step(self, dt, elevator, throttle): ...
        def observe(self): return {"alpha": ..., "q": ..., "theta": ..., "a_z": ..., "airspeed": ...}

    def make():                      # advisor gap --simulator python:my_module:make
        return Stepped(Mine(), description="my environment")

The wrapper finds steady flight, replays recorded inputs, and adds increments if supported.
"""

from collections.abc import Mapping
from inspect import signature
from math import ceil
from typing import Any, Protocol

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import CONDITIONS, CONTROLS, Condition, Increments, Inputs, Replay
from advisor.simulators.steady import midway, steady
from advisor.words.problems import UnusableInputError

_NEEDED = ("alpha", "q", "theta", "a_z")
_KEPT = ("airspeed", "height")
"""Quantities that stay at the flight condition if the environment does not observe them."""
_SIDE = ("bank", "r", "p", "a_y", "beta")
"""Quantities of roll and yaw that an environment may observe."""


class Environment(Protocol):
    """Methods that an environment must have. Angles are in rad, α, q and θ positive nose up."""

    def reset(self, speed: float, height: float, alpha: float, theta: float, **conditions: Any) -> Any:
        """Begin at a true air speed (m/s), a height (m), angles and supported conditions, without
        rotation."""

    def step(self, dt: float, **controls: float) -> Any:
        """Advance by ``dt`` seconds with ``elevator`` (rad, trailing edge down) and the supported
        controls."""

    def observe(self) -> Mapping[str, float]:
        """Return ``alpha``, ``q``, ``theta`` and ``a_z`` (m/s², -9.81 in level flight), with ``airspeed`` and
        ``height`` if variable. Quantities of roll and yaw are ``p``, ``r``, ``bank``, ``a_y`` and
        ``beta``."""


class Stepped:
    """Simulator from an environment with ``reset``, ``step`` and ``observe`` (``protocol.Simulator``).

    Parameters
    ----------
    dt
        Time step, s.
    controls
        Inputs of ``protocol.CONTROLS`` that ``step`` accepts by name.
    conditions
        Parts of the condition that ``reset`` accepts: ``mass`` in kg, ``wind`` as
        ``protocol.Condition.wind_m_s``.
    trims_throttle
        Whether the throttle is trimmed for steady speed; it must be one of ``controls``.
    increments
        Whether ``step`` accepts ``force`` (rad/s, added to α̇) and ``moment`` (rad/s², added to q̇).
    """

    speed_limit_s = 60.0

    def __init__(
        self,
        environment: Environment,
        description: str = "the environment",
        dt: float = 0.01,
        controls: tuple[str, ...] = (),
        conditions: tuple[str, ...] = (),
        trims_throttle: bool = False,
        increments: bool = False,
    ) -> None:
        self.description = description
        self.takes_increments = increments
        self.takes = frozenset(controls) & {*CONTROLS} | frozenset(conditions) & {*CONDITIONS}
        self._environment, self._dt = environment, dt
        self._side: list[str] = []
        self._flew = False
        self._controls = tuple(n for n in CONTROLS if n in self.takes or (n == "throttle" and trims_throttle))
        self._unknowns = ("alpha", "elevator", *(("throttle",) if trims_throttle else ()))

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Find steady flight, and fly the inputs as deviations from its controls."""
        self._refuse_calls()
        trim = self._trimmed(condition)
        dt = self._dt
        t = dt * np.arange(ceil(inputs.t[-1] / dt) + 1)
        middles = t[:-1] + 0.5 * dt
        given = {"elevator": inputs.elevator, **{n: y for n, y in inputs.others.items() if n in self.takes}}
        moved = {name: np.interp(middles, inputs.t, y) for name, y in given.items()}
        still = np.zeros(middles.size)
        self._begin(condition, trim)
        rows = [self._seen(condition)]
        for k, now in enumerate(middles):
            controls = {name: trim.get(name, 0.0) + float(y[k]) for name, y in moved.items()}
            if increments is not None and self.takes_increments:
                state = midway(rows, now, dt, moved["elevator"][k], moved.get("throttle", still)[k])
                controls["force"], controls["moment"] = increments(state)
            self._environment.step(dt, **self._with_trim(trim, controls))
            rows.append(self._seen(condition))
        held = {name: value for name, value in trim.items() if name != "alpha"}
        seen = dict(zip((*_NEEDED, "airspeed_m_s", "height_m", *self._side), np.array(rows).T, strict=True))
        return Replay(t, **seen, trim=held)

    def linearise(self, condition: Condition) -> None:
        """Return None, because derivatives are identified from replays."""

    def close(self) -> None:
        """Close the environment, if it has a method for that."""
        getattr(self._environment, "close", lambda: None)()

    def _refuse_calls(self) -> None:
        """Refuse an environment whose ``step`` or ``reset`` does not accept the arguments that are sent."""
        increments = ("force", "moment") if self.takes_increments else ()
        sent = {
            "step": ("dt", "elevator", *self._controls, *increments),
            "reset": ("speed", "height", "alpha", "theta", *(n for n in CONDITIONS if n in self.takes)),
        }
        for name, arguments in sent.items():
            try:
                wanted = signature(getattr(self._environment, name))
            except ValueError:  # a compiled method tells no arguments
                continue
            try:
                # The step is handed over by its place.
                wanted.bind(*arguments[: name == "step"], **dict.fromkeys(arguments[name == "step" :]))
            except TypeError as error:
                raise UnusableInputError(
                    "simulator_call",
                    f"{self.description}: {name}() {error}; it is called with {', '.join(arguments)}.",
                    f"Give {name}() these arguments, or name others in Stepped(controls=..., "
                    "conditions=..., increments=...).",
                ) from None

    def _begin(self, condition: Condition, trim: Mapping[str, float]) -> None:
        alpha = trim["alpha"]
        flown = {"mass": condition.mass_kg, "wind": condition.wind_m_s}
        taken = {name: flown[name] for name in CONDITIONS if name in self.takes and flown[name] is not None}
        self._environment.reset(
            speed=condition.airspeed_m_s, height=condition.height_m, alpha=alpha,
            theta=condition.flight_path_rad + alpha, **taken,
        )  # fmt: skip

    def _with_trim(self, trim: Mapping[str, float], controls: Mapping[str, float]) -> dict[str, float]:
        """Return the controls of one step; unlogged controls stay at the trim, or at 0."""
        resting = {name: value for name, value in trim.items() if name != "alpha"}
        return {**dict.fromkeys(self._controls, 0.0), **resting, **controls}

    def _seen(self, condition: Condition) -> list[float]:
        """Return α, q, θ, a_z, air speed, height and the observed quantities of roll and yaw."""
        seen = self._environment.observe()
        missing = [name for name in _NEEDED if name not in seen]
        if missing:
            raise UnusableInputError(
                "simulator_observation",
                f"{self.description} observes no {', '.join(missing)}.",
                "Return alpha, q, theta and a_z from observe().",
            )
        broken = {name: value for name, value in seen.items() if not np.isfinite(float(value))}
        if broken and not self._flew:
            name, value = next(iter(broken.items()))
            raise UnusableInputError(
                "simulator_observation",
                f"{self.description} observes {name} as {value} at the start of the flight.",
                "Return a finite number from observe() after reset().",
            )
        kept = {"airspeed": condition.airspeed_m_s, "height": condition.height_m}
        self._side = [name for name in _SIDE if name in seen]
        return [float(({**kept, **seen})[name]) for name in (*_NEEDED, *_KEPT, *self._side)]

    def _trimmed(self, condition: Condition) -> dict[str, float]:
        """Return controls and α for which two first steps change nothing (Newton's method)."""

        def rates(at: FloatArray) -> FloatArray:
            trim = dict(zip(self._unknowns, at.tolist(), strict=True))
            self._begin(condition, trim)
            rest = self._with_trim(trim, {})
            # A rate is that of the second step: some environments apply a control one step later.
            self._environment.step(self._dt, **rest)
            before = self._seen(condition)
            self._environment.step(self._dt, **rest)
            after = self._seen(condition)
            change = (np.array(after) - np.array(before)) / self._dt
            along = change[4] / condition.airspeed_m_s
            self._flew = True
            return np.array([change[0], change[1], along])[: len(self._unknowns)]

        at = np.zeros(len(self._unknowns))
        at[2:] = 0.5
        solution = steady(rates, at)
        if solution is not None:
            return dict(zip(self._unknowns, solution.tolist(), strict=True))
        raise UnusableInputError(
            "simulator_trim",
            f"{self.description} finds no steady flight at {condition.airspeed_m_s:.4g} m/s and "
            f"{condition.height_m:.4g} m.",
            "Check that reset() takes the angle of attack, and that step() moves the elevator in rad.",
        )
