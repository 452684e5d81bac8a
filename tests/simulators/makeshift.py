"""Simulators that other processes build: one that flies, and some that do what foreign code does."""

import os
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from advisor.simulators.protocol import Condition, Increments, Inputs, Replay, State
from advisor.words.problems import UnusableInputError

STANDARD_GRAVITY = 9.80665


class Level:
    """Flies level whatever is commanded."""

    description = "level"
    takes_increments = True
    takes = frozenset({"throttle"})
    speed_limit_s = 5.0

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        still = np.zeros(inputs.t.size)
        alpha = still.copy()
        if increments is not None:
            alpha = still + increments(State(0.0, 0.0, 0.0, 0.0, 0.0, condition.airspeed_m_s, 0.0, 0.0))[0]
        return Replay(
            inputs.t,
            alpha,
            still,
            still,
            still - STANDARD_GRAVITY,
            still + condition.airspeed_m_s,
            still + condition.height_m,
        )

    def linearise(self, condition: Condition) -> Mapping[str, float] | None:
        return {"M_alpha": -condition.airspeed_m_s}

    def close(self) -> None:
        pass


class Trimmed(Level):
    """Says at which controls it is trimmed."""

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        flown = super().replay(condition, inputs, increments)
        return replace(flown, trim={"elevator": -0.02, "throttle": 0.4})


class Constant:
    """Increments that are equal in every state."""

    def __init__(self, force: float, moment: float) -> None:
        self._both = (force, moment)

    def __call__(self, state: State) -> tuple[float, float]:
        return self._both


class Damping:
    """A moment against the pitch rate."""

    def __init__(self, m_q: float) -> None:
        self._m_q = m_q

    def __call__(self, state: State) -> tuple[float, float]:
        return 0.0, self._m_q * state.q


class Faulty(Level):
    """Does in a replay what its argument says."""

    def __init__(self, fault: str) -> None:
        self._fault = fault

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        flown = super().replay(condition, inputs, increments)
        if self._fault == "hang":
            time.sleep(3600.0)
        if self._fault == "crash":
            os.abort()
        if self._fault == "leave":
            os._exit(7)
        if self._fault == "raise":
            raise PrivateError("the wing is off")
        if self._fault == "refuse":
            raise UnusableInputError("simulator_trim", "No trim.", "Fly faster.")
        if self._fault == "nan":
            flown.q[3] = np.nan
        if self._fault == "devour":
            np.ones(2**30)  # 8 GiB
        if self._fault.startswith("helper"):
            helper = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(3600)"])
            Path(self._fault.partition(":")[2]).write_text(str(helper.pid))
            time.sleep(3600.0)
        if self._fault == "print":
            os.write(1, b"noise\n")
            print("more noise", flush=True)
        return flown


class PrivateError(Exception):
    """A class of foreign code."""


def fails() -> Level:
    raise RuntimeError("no licence")


def never_ready() -> Level:
    time.sleep(3600.0)
    raise AssertionError
