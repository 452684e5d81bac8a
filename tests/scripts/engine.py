"""A stub of ArduPilot's scripting engine with a simulated clock, in which a Lua interpreter runs a script."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from lupa import lua53

BUDGET = 10_000
"""Instructions that ArduPilot allows a call (SCR_VM_I_COUNT)."""
USUAL: Mapping[str, float] = {
    **{f"SERVO{n}_{name}": value for n in range(1, 17) for name, value in
       (("MIN", 1100.0), ("TRIM", 1500.0), ("MAX", 1900.0), ("REVERSED", 0.0), ("FUNCTION", 0.0))},
    "SERVO1_FUNCTION": 4.0, "SERVO2_FUNCTION": 19.0, "SERVO3_FUNCTION": 70.0, "SERVO4_FUNCTION": 21.0,
    "RCMAP_ROLL": 1.0, "RCMAP_PITCH": 2.0, "RCMAP_THROTTLE": 3.0, "RCMAP_YAW": 4.0,
    "AIRSPEED_MIN": 10.0, "SCR_USER1": 0.0, "SCR_USER2": 0.0, "SCR_USER3": 0.0, "SCR_USER4": 0.0,
}  # fmt: skip
"""ArduPlane's defaults of the parameters that a script reads."""

_PRELUDE = """
local Clock = {}
local function clock(v) return setmetatable({v = v}, Clock) end
Clock.__index = {toint = function(c) return c.v end, tofloat = function(c) return c.v + 0.0 end}
Clock.__sub = function(a, b) return clock(a.v - b.v) end
function millis() return clock(engine.ms()) end
param = {get = function(_, name) return engine.parameter(name) end}
function Parameter()
  local p = {}
  function p:init(name) self.name = name return engine.parameter(name) ~= nil end
  function p:get() return engine.parameter(self.name) end
  return p
end
rc = {
  get_pwm = function(_, n) return engine.radio(n) end,
  has_valid_input = function() return engine.radio_is_valid() end,
  get_channel = function(_, n)
    local trim, travel = n == 3 and 1000 or 1500, n == 3 and 1000 or 500
    return {norm_input = function() return (engine.radio(n) - trim) / travel end}
  end,
}
arming = {is_armed = function() return engine.armed() end}
vehicle = {get_mode = function() return engine.mode() end}
ahrs = {
  get_roll = function() return engine.state("roll") end,
  get_pitch = function() return engine.state("pitch") end,
  airspeed_estimate = function() return engine.state("airspeed") end,
  get_relative_position_D_home = function() return -engine.state("height") end,
}
gcs = {
  send_text = function(_, _, text) engine.say(text) end,
  last_seen = function() return clock(engine.link_ms()) end,
}
SRV_Channels = {
  find_channel = function(_, role) return engine.channel(role) end,
  get_output_pwm = function(_, role) return engine.pulse(role) end,
  set_output_pwm_chan_timeout = function(_, channel, us, ms)
    assert(math.type(us) == "integer" and math.type(channel) == "integer")
    engine.override(channel, us, ms)
  end,
}
local spent = 0
function counted(call)
  spent = 0
  debug.sethook(function() spent = spent + 10 end, "", 10)
  local again, wait = call()
  debug.sethook()
  return again, wait, spent
end
"""


@dataclass
class Engine:
    """An autopilot that flies level at 20 m/s, 100 m above home, in mode 5 with the sticks at rest."""

    parameters: dict[str, float] = field(default_factory=lambda: dict(USUAL))
    call_ms: int = 10
    """Time between two calls of the script, ms, at least."""
    ms: int = 5_000
    armed: bool = True
    mode: int = 5
    radio: dict[int, int] = field(default_factory=lambda: {1: 1500, 2: 1500, 3: 1500, 4: 1500, 7: 1000})
    radio_is_valid: bool = True
    link_ms: int = 0
    state: dict[str, float] = field(
        default_factory=lambda: {"roll": 0.0, "pitch": 0.0, "airspeed": 20.0, "height": 100.0}
    )
    flown: dict[int, int] = field(default_factory=lambda: {1: 1504, 2: 1490, 3: 1500, 4: 1500, 5: 1516})
    """Pulse that the autopilot itself gives each output, us."""
    texts: list[tuple[int, str]] = field(default_factory=list)
    """Texts with their times, ms."""
    most: int = 0
    """Largest number of instructions of a call."""

    def __post_init__(self) -> None:
        self._overrides: dict[int, tuple[int, int]] = {}
        self._next: Any = None
        self._due_ms = 0

    def load(self, script: str) -> None:
        """Run a script's main chunk, which returns the function of the next call."""
        self._lua = lua53.LuaRuntime(unpack_returned_tuples=True)
        calls: dict[str, Callable[..., Any]] = {
            "ms": lambda: self.ms,
            "parameter": lambda name: self.parameters.get(name),
            "radio": lambda n: self.radio.get(int(n)),
            "radio_is_valid": lambda: self.radio_is_valid,
            "armed": lambda: self.armed,
            "mode": lambda: self.mode,
            "state": lambda name: self.state[name],
            "say": lambda text: self.texts.append((self.ms, text)),
            "link_ms": lambda: self.link_ms,
            "channel": self._channel,
            "pulse": lambda role: None if (c := self._channel(role)) is None else self.pulse(c + 1),
            "override": self._override,
        }
        self._lua.globals()["engine"] = self._lua.table_from(calls)
        self._lua.execute(_PRELUDE)
        self._next = self._lua.eval("function(text) return assert(load(text)) end")(script)
        self._call()

    def pulse(self, n: int) -> int:
        """Return the pulse of an output now, us: the script's or, where not held, the autopilot's."""
        us, until_ms = self._overrides.get(n, (0, 0))
        return us if self.ms < until_ms else self.flown.get(n, 1500)

    def run(self, seconds: float, each: Callable[[], None] | None = None) -> None:
        """Let time pass in steps of 1 ms, and call ``each`` after each of them."""
        for _ in range(round(1000 * seconds)):
            self.ms += 1
            if self.ms >= self._due_ms:
                self._call()
            if each is not None:
                each()

    def said(self, begin: str) -> list[str]:
        """Return the texts that begin so."""
        return [text for _, text in self.texts if text.startswith(begin)]

    def at_ms(self, begin: str) -> int:
        """Return the time of the newest text that begins so, ms."""
        return next(ms for ms, text in reversed(self.texts) if text.startswith(begin))

    def _call(self) -> None:
        self._next, wait_ms, spent = self._lua.globals()["counted"](self._next)
        self.most = max(self.most, spent)
        self._due_ms = self.ms + max(int(wait_ms), self.call_ms)

    def _channel(self, role: float) -> int | None:
        mine = (n for n in range(1, 17) if self.parameters[f"SERVO{n}_FUNCTION"] == role)
        return next((n - 1 for n in mine), None)

    def _override(self, channel: int, us: int, timeout_ms: int) -> None:
        self._overrides[channel + 1] = (us, self.ms + timeout_ms)
