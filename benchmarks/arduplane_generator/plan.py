"""Test inputs of one flight, and the script with which the autopilot flies them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .airframe import FULL_RAD, Airframe

OUTPUTS = {"aileron": 1, "elevator": 2, "rudder": 4}
"""Servo output of each control, counted from 1."""
FUNCTIONS = {"aileron": 4, "elevator": 19, "rudder": 21}
"""ArduPilot's number for the function of each servo output."""
US_OF_FULL = 500.0
FREE_S = {"elevator": 3.2, "aileron": 2.5, "rudder": 4.0}
"""Time with fixed controls after an input, s."""
END = "FLIGHT END"
"""Text that the script sends after the last input."""
_SHAPES = {
    "3211": ((3, 1), (2, -1), (1, 1), (1, -1)),
    "rev": ((3, -1), (2, 1), (1, -1), (1, 1)),
    "doublet": ((2, 1), (2, -1)),
    "121": ((1, 1), (2, -1), (1, 1)),
}
"""Shape to its steps, each as a length in units and a sign."""
ORDER = (
    ("elevator", "3211"), ("aileron", "doublet"), ("elevator", "rev"), ("rudder", "doublet"),
    ("elevator", "3211"), ("aileron", "121"), ("elevator", "doublet"), ("rudder", "3211"),
    ("elevator", "rev"), ("aileron", "doublet"), ("rudder", "doublet"), ("elevator", "3211"),
)  # fmt: skip
"""Controls and shapes of a flight, in the order flown."""


@dataclass(frozen=True)
class Input:
    """One test input."""

    control: str
    steps: tuple[tuple[float, float], ...]
    """Length in s and pulse from the trim in us of each step."""


def inputs_of(airframe: Airframe, rng: np.random.Generator) -> tuple[Input, ...]:
    """Return the inputs of a flight, sized by the airframe's response."""
    d = airframe.derivatives(airframe.speed_m_s)
    short = np.sqrt(max(-d["M_alpha"] - d["Z_alpha"] * -d["M_q"], 4.0))
    dutch = np.sqrt(max(d["N_beta"], 4.0))
    unit = {"elevator": 1.9 / short, "aileron": 0.45, "rudder": 1.6 / dutch}
    rise = {
        "elevator": np.radians(3.0) * abs(d["M_alpha"] / d["M_delta_e"]),
        "aileron": np.radians(28.0) * abs(d["L_p"] / d["L_delta_a"]),
        "rudder": np.radians(5.0) * abs(d["N_beta"] / d["N_delta_r"]),
    }

    def drawn(control: str, shape: str) -> Input:
        size = US_OF_FULL * rise[control] / FULL_RAD * float(rng.uniform(0.6, 1.2))
        steps = ((length * unit[control], round(sign * size)) for length, sign in _SHAPES[shape])
        return Input(control, tuple((round(float(t), 3), float(us)) for t, us in steps))

    return tuple(drawn(control, shape) for control, shape in ORDER)


def script(inputs: Sequence[Input], throttle_us: int, height_m: float, speed_m_s: float) -> str:
    """Return the Lua script that flies the inputs in MANUAL, and holds height and speed between them.

    Between the inputs FBWA keeps the wings level, and a small stick and the throttle regain height (m) and
    read air speed (m/s).
    """
    rows = []
    for one in inputs:
        steps = ", ".join(f"{{{t:.3f}, {us:.0f}}}" for t, us in one.steps)
        channel, function = OUTPUTS[one.control] - 1, FUNCTIONS[one.control]
        rows.append(f"  {{{channel}, {FREE_S[one.control]}, {{{steps}}}, {function}}},")
    return _LUA.format(
        inputs="\n".join(rows), throttle=throttle_us, height=height_m, speed=speed_m_s, end=END
    )


_LUA = """-- test inputs one after another: FBWA holds the height between, MANUAL during each input
local inputs = {{
{inputs}
}}
local FBWA, MANUAL = 5, 0
local HOLD, LONGEST, REST, HELD_MS = 5.0, 25.0, 3.0, 400
local k, phase, since, trim = 0, "wait", 0, 1500
local function now() return millis():tofloat() * 0.001 end
local function stick(n, us) rc:get_channel(n):set_override(us) end
local function enter(p) phase = p; since = now() end
local function held(t)
  local steps, at = inputs[k][3], 0
  for i = 1, #steps do
    at = at + steps[i][1]
    if t < at then return steps[i][2] end
  end
  return nil
end
function update()
  local t = now() - since
  if phase == "wait" then
    if Parameter("SCR_USER1"):get() == 1 then k = 1; vehicle:set_mode(FBWA); enter("hold") end
    return update, 100
  end
  local pitch, throttle = 1500, {throttle}
  if phase == "hold" then
    local home = ahrs:get_relative_position_NED_home()
    local low = {height} - (home and -home:z() or {height})
    local slow = {speed:.2f} - (ahrs:airspeed_estimate() or {speed:.2f})
    pitch = 1500 + math.floor(25 * math.max(-6, math.min(6, low / 4)) + 0.5)
    throttle = math.floor(math.max(1000, math.min(1900, throttle + 40 * slow + 10 * low)) + 0.5)
    local settled = math.abs(low) < 8 and math.abs(slow) < 0.8
    if t > HOLD and (settled or t > LONGEST) then vehicle:set_mode(MANUAL); enter("rest") end
  end
  stick(1, 1500); stick(2, pitch); stick(3, throttle); stick(4, 1500)
  if phase == "hold" then return update, 20
  elseif phase == "rest" and t > REST then
    trim = SRV_Channels:get_output_pwm(inputs[k][4]) or 1500
    enter("fly")
  elseif phase == "fly" then
    local us = held(t)
    -- The script may pause on a busy computer, so an output is held longer than one call.
    SRV_Channels:set_output_pwm_chan_timeout(inputs[k][1], math.floor(trim + (us or 0) + 0.5), HELD_MS)
    if not us then enter("free") end
  elseif phase == "free" and t > inputs[k][2] then
    k = k + 1; vehicle:set_mode(FBWA)
    if k > #inputs then gcs:send_text(5, "{end}"); enter("over") else enter("hold") end
  end
  return update, 20
end
return update()
"""
