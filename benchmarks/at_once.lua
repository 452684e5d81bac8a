-- three multisines of elevator, aileron and rudder at once: FBWA holds the height between, MANUAL during each
local LENGTH_S, STRETCHES, HOLD_S, REST_S, FREE_S = 20.0, 3, 8.0, 2.0, 3.5
local FBWA, MANUAL = 5, 0
local CHANNELS, FUNCTIONS, SIZES_US = {0, 1, 3}, {4, 19, 21}, {45, 35, 40}
local LINES = {{7, 13, 19, 25, 31, 37, 43}, {6, 12, 18, 24, 30, 36, 42}, {5, 11, 17, 23, 29, 35, 41}}
local PEAKS = {3.673, 3.567, 3.657}   -- largest value of each sum of sines
local k, phase, since, trims = 0, "wait", 0, {}
local function now() return millis():tofloat() * 0.001 end
local function enter(p) phase = p; since = now() end
local function stick(n, us) rc:get_channel(n):set_override(us) end
local function sines(c, t)
  local y, n = 0, #LINES[c]
  for i = 1, n do y = y + math.sin(2 * math.pi * LINES[c][i] * t / LENGTH_S - math.pi * i * (i - 1) / n) end
  return math.min(t, LENGTH_S - t, 1) * SIZES_US[c] * y / PEAKS[c]
end
function update()
  local t = now() - since
  if phase == "wait" then
    if Parameter("SCR_USER1"):get() == 1 then vehicle:set_mode(FBWA); enter("hold") end
    return update, 100
  end
  local pitch = 1500
  if phase == "hold" then
    local home = ahrs:get_relative_position_NED_home()
    local low = 50 - (home and -home:z() or 50)
    pitch = 1500 + math.floor(25 * math.max(-3, math.min(3, low / 10)) + 0.5)
    if t > HOLD_S then vehicle:set_mode(MANUAL); enter("rest") end
  end
  stick(1, 1500); stick(2, pitch); stick(3, 1480); stick(4, 1500)
  if phase == "rest" and t > REST_S then
    for c = 1, 3 do trims[c] = SRV_Channels:get_output_pwm(FUNCTIONS[c]) or 1500 end
    k = k + 1
    gcs:send_text(5, string.format("ADVISOR BEGIN %d multisine", k))
    enter("fly")
  elseif phase == "fly" then
    if t >= LENGTH_S then
      gcs:send_text(5, string.format("ADVISOR END %d done", k))
      enter("free")
    else
      for c = 1, 3 do
        local us = math.floor(trims[c] + sines(c, t) + 0.5)
        SRV_Channels:set_output_pwm_chan_timeout(CHANNELS[c], us, 200)
      end
    end
  elseif phase == "free" and t > FREE_S then
    if k == STRETCHES then gcs:send_text(5, "FLIGHT END"); enter("over") end
    vehicle:set_mode(FBWA)
    if phase == "free" then enter("hold") end
  end
  return update, 20
end
return update()
