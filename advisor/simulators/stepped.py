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

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from inspect import signature
from math import ceil
from typing import Any, Protocol

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import CONDITIONS, CONTROLS, Condition, Increments, Inputs, Replay, State
from advisor.words.problems import UnusableInputError

_NEEDED = ("alpha", "q", "theta", "a_z")
_SIDE = ("bank", "r", "p", "a_y", "beta")
"""Quantities of roll and yaw that an environment may observe."""
_DIFFERENCE = 1e-3
"""Finite-difference step of an unknown of the trim, rad or share of the throttle."""
_ROUNDS = 40
_STEADY = 1e-4
"""Rates of α (rad/s), q (rad/s²) and relative speed (1/s) below which flight counts as steady."""
_LONGEST_MOVE = 0.1
"""Longest Newton step of an angle, rad, or of the throttle."""


class Stepping(ABC):
    """Simulator that flies the recorded inputs in even steps (``protocol.Simulator``)."""

    speed_limit_s = 20.0
    description: str
    takes_increments: bool
    takes: frozenset[str]
    _dt: float
    """Time step, s."""
    _reads_at = 0.5
    """Share of a step at which the inputs of the step are read."""
    _unknowns: tuple[str, ...] = ("alpha", "elevator")
    """Unknowns of the trim: the angle of attack, and controls."""
    _trim_fix: str
    """Next step for a user whose simulator finds no steady flight."""

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Begin in steady flight, and fly the inputs as deviations from its controls."""
        rest = self._begin(condition)
        t = self._dt * np.arange(ceil(inputs.t[-1] / self._dt) + 1)
        read = t[:-1] + self._reads_at * self._dt
        given = {"elevator": inputs.elevator, **{n: y for n, y in inputs.others.items() if n in self.takes}}
        moved = {name: np.interp(read, inputs.t, y) for name, y in given.items()}
        still = np.zeros(read.size)
        rows = [self._seen(condition)]
        for k, now in enumerate(read):
            controls = {name: rest.get(name, 0.0) + float(y[k]) for name, y in moved.items()}
            if increments is not None and self.takes_increments:
                state = self._ahead(rows, now, moved["elevator"][k], moved.get("throttle", still)[k])
                controls["force"], controls["moment"] = increments(state)
            self._step(controls)
            rows.append(self._seen(condition))
        self._end()
        return Replay(t, **{name: np.array([row[name] for row in rows]) for name in rows[0]}, trim=rest)

    def linearise(self, condition: Condition) -> Mapping[str, float] | None:
        """Return None, because derivatives are identified from replays."""
        return None

    def close(self) -> None:
        """Free the resources of the simulator."""
        self._end()

    def _begin(self, condition: Condition) -> dict[str, float]:
        """Begin the flight, and return the controls of steady flight."""
        trim = self._trimmed(condition)
        self._start(condition, trim)
        return {name: value for name, value in trim.items() if name != "alpha"}

    @abstractmethod
    def _start(self, condition: Condition, trim: Mapping[str, float]) -> None:
        """Begin at the condition with the angle of attack and the controls of ``trim``."""

    @abstractmethod
    def _step(self, controls: Mapping[str, float]) -> None:
        """Advance by one step with controls, and with increments ``force`` and ``moment``."""

    @abstractmethod
    def _seen(self, condition: Condition) -> Mapping[str, float]:
        """Return the present values of the series of ``protocol.Replay``, by their names."""

    def _end(self) -> None:  # noqa: B027 - most simulators have nothing to do
        """End the flight."""

    def _rates(self, rows: Sequence[Mapping[str, float]]) -> tuple[float, float]:
        """Return the rates of α and of q, here those of the last step."""
        before, now = rows[-2] if len(rows) > 1 else rows[-1], rows[-1]
        return (now["alpha"] - before["alpha"]) / self._dt, (now["q"] - before["q"]) / self._dt

    def _ahead(
        self, rows: Sequence[Mapping[str, float]], t: float, elevator: float, throttle: float
    ) -> State:
        """Return the state at the time ``t`` within the next step, extrapolated by the rates."""
        now, (alpha_dot, q_dot) = rows[-1], self._rates(rows)
        ahead = self._reads_at * self._dt
        return State(
            float(t), now["alpha"] + ahead * alpha_dot, alpha_dot, now["q"] + ahead * q_dot, float(elevator),
            now["airspeed_m_s"], now["height_m"], float(throttle),
        )  # fmt: skip

    def _trimmed(self, condition: Condition) -> dict[str, float]:
        """Return α and the controls for which the second of two steps changes nothing."""

        def rates(at: FloatArray) -> FloatArray:
            trim = dict(zip(self._unknowns, at.tolist(), strict=True))
            self._start(condition, trim)
            rest = {name: value for name, value in trim.items() if name != "alpha"}
            # A rate is that of the second step: some environments apply a control one step later.
            self._step(rest)
            before = self._seen(condition)
            self._step(rest)
            after = self._seen(condition)
            change = [(after[name] - before[name]) / self._dt for name in ("alpha", "q", "airspeed_m_s")]
            return np.array([*change[:2], change[2] / condition.airspeed_m_s])[: len(self._unknowns)]

        at = np.zeros(len(self._unknowns))
        at[2:] = 0.5
        solution = steady(rates, at)
        if solution is not None:
            return dict(zip(self._unknowns, solution.tolist(), strict=True))
        raise UnusableInputError(
            "simulator_trim",
            f"{self.description} finds no steady flight at {condition.airspeed_m_s:.4g} m/s and "
            f"{condition.height_m:.4g} m.",
            self._trim_fix,
        )


def steady(rates: Callable[[FloatArray], FloatArray], start: FloatArray) -> FloatArray | None:
    """Return the unknowns for which all rates are zero (Newton's method); None if none are found.

    Parameters
    ----------
    rates
        Function that returns the rates for the unknowns, both of shape (n,).
    """
    at = start
    for _ in range(_ROUNDS):
        now = rates(at)
        if np.max(np.abs(now)) < _STEADY:
            return at
        steps = _DIFFERENCE * np.eye(len(at))
        slopes = np.column_stack([(rates(at + h) - rates(at - h)) / (2.0 * _DIFFERENCE) for h in steps])
        if not np.all(np.isfinite(slopes)) or np.linalg.matrix_rank(slopes) < len(at):
            return None
        move = np.linalg.solve(slopes, -now)
        at = at + move * min(1.0, _LONGEST_MOVE / float(np.max(np.abs(move))))
    return None


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


class Stepped(Stepping):
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
    _trim_fix = "Check that reset() takes the angle of attack, and that step() moves the elevator in rad."

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
        self._flew = False
        self._controls = tuple(n for n in CONTROLS if n in self.takes or (n == "throttle" and trims_throttle))
        self._unknowns = ("alpha", "elevator", *(("throttle",) if trims_throttle else ()))

    def close(self) -> None:
        """Close the environment, if it has a method for that."""
        getattr(self._environment, "close", lambda: None)()

    def _begin(self, condition: Condition) -> dict[str, float]:
        self._refuse_calls()
        return super()._begin(condition)

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

    def _start(self, condition: Condition, trim: Mapping[str, float]) -> None:
        alpha = trim["alpha"]
        flown = {"mass": condition.mass_kg, "wind": condition.wind_m_s}
        taken = {name: flown[name] for name in CONDITIONS if name in self.takes and flown[name] is not None}
        self._environment.reset(
            speed=condition.airspeed_m_s, height=condition.height_m, alpha=alpha,
            theta=condition.flight_path_rad + alpha, **taken,
        )  # fmt: skip
        # Controls that the flight did not log stay at the trim, or at 0.
        self._resting = {
            **dict.fromkeys(self._controls, 0.0),
            **{n: v for n, v in trim.items() if n != "alpha"},
        }

    def _step(self, controls: Mapping[str, float]) -> None:
        self._environment.step(self._dt, **{**self._resting, **controls})

    def _seen(self, condition: Condition) -> Mapping[str, float]:
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
        self._flew = True
        motion = {name: float(seen[name]) for name in (*_NEEDED, *_SIDE) if name in seen}
        motion["airspeed_m_s"] = float(seen.get("airspeed", condition.airspeed_m_s))
        return {**motion, "height_m": float(seen.get("height", condition.height_m))}
