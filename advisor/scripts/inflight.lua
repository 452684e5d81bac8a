-- @DATA@
-- From here on the script holds no number that depends on the aircraft.

local CALL_MS = 10        -- ms between two calls; a board that is slower calls as fast as it can
local TIMEOUT_MS = 150    -- ms, four frames of a 30 Hz board, after which an output of a dead script is the autopilot's
local LATE_MS = 40        -- ms between two calls above which a text says that the steps are inexact
local START_US = 1700     -- us above which the switch starts the next input
local END_US = 1300       -- us below which the switch ends an input at once
local BOUNCE_MS = 300     -- ms for which the switch must stay up, so that a switch that bounces starts nothing
local STEADY_MS = 2000    -- ms of steady flight before an input
local TRIM_MS = 1000      -- ms at the end of the steady flight over which the trim is averaged
local STEADY_DEG = 10     -- deg by which bank and pitch may change in the steady flight
local REMIND_MS = 5000    -- ms between two texts while the script waits for steady flight
local NOTICE = 5          -- severity of the texts

local outputs = {elevator = {}, aileron = {}, rudder = {}}   -- outputs of each control: number, factor, calibration
local scales = {}         -- limits and function of each output, from the vehicle's parameters
local blocked = nil       -- reason why no input can begin

local function say(text) gcs:send_text(NOTICE, text) end

-- Time since a time of the clock, ms.
local function since(earlier) return (millis() - earlier):toint() end

local function scale_of(n)
  if scales[n] == nil then
    local begin = "SERVO" .. n .. "_"
    scales[n] = {
      low = param:get(begin .. "MIN") or 1100,
      trim = param:get(begin .. "TRIM") or 1500,
      high = param:get(begin .. "MAX") or 1900,
      turn = (param:get(begin .. "REVERSED") or 0) > 0.5 and -1 or 1,
      role = math.floor(param:get(begin .. "FUNCTION") or 0),
    }
  end
  return scales[n]
end

-- A calibration of a control's first output, carried over to another output of the linkage.
local function carried_over(us_deg, first, other)
  local turn, moved = first.turn * other.turn, {}
  for k, pair in ipairs(us_deg) do
    local at = turn > 0 and k or #us_deg + 1 - k
    moved[at] = {other.trim + turn * (pair[1] - first.trim), pair[2]}
  end
  return moved
end

local function add_output(control, n, factor, us_deg)
  local scale, mine = scale_of(n), outputs[control]
  if us_deg == nil and CALIBRATION[control] ~= nil then
    us_deg = CALIBRATION[control]
    if #mine > 0 then us_deg = carried_over(us_deg, scale_of(mine[1].n), scale) end
  end
  if us_deg == nil then
    if scale.low >= scale.trim or scale.trim >= scale.high then
      blocked = "SERVO" .. n .. "_MIN/TRIM/MAX do not rise"
      return
    end
    us_deg = {
      {scale.low, FULL_TRAVEL_DEG * scale.turn}, {scale.trim, 0}, {scale.high, -FULL_TRAVEL_DEG * scale.turn},
    }
  end
  if scale.role == 0 then blocked = "output " .. n .. " has function 0" end
  mine[#mine + 1] = {
    n = n, factor = factor, us_deg = us_deg,
    low = math.max(scale.low, us_deg[1][1]), high = math.min(scale.high, us_deg[#us_deg][1]),
  }
end

local function find_outputs()
  for control, stated in pairs(STATED) do
    for _, one in ipairs(stated) do add_output(control, one.n, one.factor, one.us_deg) end
  end
  for n = 1, 16 do
    local factors = FACTORS[math.floor(param:get("SERVO" .. n .. "_FUNCTION") or 0)]
    for control, factor in pairs(factors or {}) do
      if #STATED[control] == 0 then add_output(control, n, factor, nil) end
    end
  end
end

-- Deflection of an output at a pulse, deg.
local function deflection(us_deg, us)
  local k = 1
  while k < #us_deg - 1 and us > us_deg[k + 1][1] do k = k + 1 end
  local a, b = us_deg[k], us_deg[k + 1]
  return a[2] + (us - a[1]) * (b[2] - a[2]) / (b[1] - a[1])
end

-- Pulse of an output at a deflection, us.
local function pulse(us_deg, deg)
  local k, rises = 1, us_deg[#us_deg][2] > us_deg[1][2]
  while k < #us_deg - 1 and (deg > us_deg[k + 1][2]) == rises do k = k + 1 end
  local a, b = us_deg[k], us_deg[k + 1]
  return a[1] + (deg - a[2]) * (b[1] - a[1]) / (b[2] - a[2])
end

-- Pulse that an output has now, us. The autopilot tells that of the first output of each function.
local function pulse_now(n)
  local mine = scales[n]
  local us, first = SRV_Channels:get_output_pwm(mine.role), SRV_Channels:find_channel(mine.role)
  if us == nil or first == nil or first + 1 == n then return us end
  local other = scale_of(first + 1)
  local share = (us - other.trim) * other.turn * mine.turn
  share = share / (us < other.trim and other.trim - other.low or other.high - other.trim)
  return mine.trim + share * (share < 0 and mine.trim - mine.low or mine.high - mine.trim)
end

local function switch_us()
  if SWITCH < 300 then return rc:get_pwm(SWITCH) or 0 end
  local channel = rc:find_channel_for_option(SWITCH)
  return channel and 1000 + 500 * channel:get_aux_switch_pos() or 0
end

local sticks = {}         -- channels of roll, pitch, throttle and yaw
for k, name in ipairs({"RCMAP_ROLL", "RCMAP_PITCH", "RCMAP_THROTTLE", "RCMAP_YAW"}) do
  sticks[k] = rc:get_channel(math.floor(param:get(name) or k))
end
local slowest = param:get("AIRSPEED_MIN") or param:get("ARSPD_FBW_MIN") or 0

-- State of the aircraft, to which an input compares every later one.
local function now_flown()
  local flown = {mode = vehicle:get_mode(), sticks = {}, link = false}
  flown.bank, flown.pitch = math.deg(ahrs:get_roll()), math.deg(ahrs:get_pitch())
  flown.airspeed = ahrs:airspeed_estimate()
  for k, stick in ipairs(sticks) do flown.sticks[k] = stick:norm_input() end
  local heard = gcs:last_seen()
  flown.link = heard:toint() ~= 0 and since(heard) < 1000 * LINK_S
  return flown
end

local function moved_stick(before, now, percent)
  for k, position in ipairs(now.sticks) do
    if math.abs(position - before.sticks[k]) > 0.01 * percent then return true end
  end
  return false
end

-- Reason to end an input at once, or nil.
local function trouble(before, now)
  if switch_us() < END_US then return "switch" end
  if not arming:is_armed() then return "disarmed" end
  if not rc:has_valid_input() then return "RC failsafe" end
  if before.link and not now.link then return "link lost" end
  if now.mode ~= before.mode then return "mode changed" end
  if moved_stick(before, now, STICK_PERCENT) then return "stick" end
  local pitched = now.pitch - before.pitch
  if math.abs(now.bank) > BANK_DEG then return string.format("bank %.0f deg", now.bank) end
  if math.abs(pitched) > PITCH_DEG then return string.format("pitch by %.0f deg", pitched) end
  if LOWEST_M <= 0 then return nil end   -- a script for the ground check has neither height nor air speed
  local down = ahrs:get_relative_position_D_home()
  if down == nil then return "height unknown" end
  if -down < LOWEST_M then return string.format("height %.0f m", -down) end
  if now.airspeed ~= nil and before.airspeed ~= nil then
    local change = 100 * (now.airspeed / before.airspeed - 1)
    if math.abs(change) > AIRSPEED_PERCENT then return string.format("air speed by %.0f %%", change) end
    if now.airspeed < slowest then return "air speed below AIRSPEED_MIN" end
  end
  return nil
end

local phase = "idle"      -- idle, up (the switch is up), steady, flying, spent (until the switch is down)
local since_ms = millis() -- begin of the phase
local reminded = millis() -- time of the last text about waiting
local before = nil        -- state of the aircraft at the begin of the steady flight, then of the input
local trims = {}          -- sum and count of the pulses of each output, then the trim
local sent = {}           -- newest pulse of each output that the script holds
local at = 0              -- place in TABLE of the newest input
local number = 0          -- number of inputs flown since the script was loaded
local order = nil         -- input that the advisor asked for by SCR_USER1 to 4
local test = nil          -- input that is flown, with its size and unit
local called = millis()   -- time of the newest call
local latest_ms = 0       -- longest time between two calls during the input, ms
local was_armed = false

local function enter(name)
  phase, since_ms = name, millis()
end

local function length_of(one)
  if one.test.sines then return one.test.length_s end
  local units = 0
  for _, step in ipairs(one.test.steps) do units = units + step[1] end
  return units * one.unit_s
end

-- Next input: the advisor's order, else the next one of the table whose controls the aircraft has.
local function next_input()
  if order ~= nil then return order end
  for k = 1, #TABLE do
    local place = (at + k - 1) % #TABLE + 1
    local candidate = INPUTS[TABLE[place]]
    if #outputs[candidate.moves[1]] > 0 then
      return {test = candidate, place = place, scale = 1, unit_s = candidate.unit_s, counter = 0}
    end
  end
  return nil
end

local function say_next()
  local one = next_input()
  if one == nil then return end
  local size = one.scale * one.test.sizes[one.test.moves[1]]
  say(string.format("ADVISOR NEXT %d %s %.2f s %.1f deg", one.counter, one.test.name, one.unit_s, size))
end

-- Deflection of a control at a time after the begin, deg.
local function asked(control, t)
  local one, share = test.test, 0
  if t >= test.length_s or one.sizes[control] == nil then return 0 end
  if one.sines then
    local lines, turn = one.sines[control], 2 * math.pi * t / one.length_s
    for k = 1, #lines do share = share + math.sin(turn * lines[k][1] + lines[k][2]) end
    share = share * lines.amplitude
  else
    local units = t / test.unit_s + 0.0001
    for k = 1, #one.steps do
      units = units - one.steps[k][1]
      if units < 0 then
        share = one.steps[k][2]
        break
      end
    end
  end
  return share * test.scale * one.sizes[control]
end

-- Pulses of all held outputs for deflections from trim, us; with the number of an output without travel.
local function mixed(of)
  local pulses, short = {}, nil
  for _, control in ipairs(test.test.held) do
    local deg = of(control)
    for _, output in ipairs(outputs[control]) do
      local us = pulses[output.n] or trims[output.n]
      if deg ~= 0 then us = pulse(output.us_deg, deflection(output.us_deg, us) + output.factor * deg) end
      if us < output.low - 0.5 or us > output.high + 0.5 then short = output.n end
      pulses[output.n] = us
    end
  end
  return pulses, short
end

local function send(pulses)
  for n, us in pairs(pulses) do
    local scale = scales[n]
    sent[n] = math.floor(math.min(math.max(us, scale.low), scale.high) + 0.5)
    SRV_Channels:set_output_pwm_chan_timeout(n - 1, sent[n], TIMEOUT_MS)
  end
end

local function give_back()
  for n, us in pairs(sent) do SRV_Channels:set_output_pwm_chan_timeout(n - 1, us, 0) end
  sent = {}
end

local function finish(how)
  give_back()
  say(string.format("ADVISOR END %d %s", number, how))
  if latest_ms > LATE_MS then say(string.format("ADVISOR LATE: calls up to %d ms apart in %d", latest_ms, number)) end
  test = nil
  enter("spent")
  say_next()
end

local function wait_for(why)
  if since(reminded) > REMIND_MS then
    reminded = millis()
    say("ADVISOR WAITS: " .. why)
  end
  before, trims = now_flown(), {}
  enter("steady")
end

local function add_trims()
  for _, control in ipairs(test.test.held) do
    for _, output in ipairs(outputs[control]) do
      local us, sum = pulse_now(output.n), trims[output.n] or {0, 0}
      if us == nil then return "output " .. output.n .. " has no pulse" end
      trims[output.n] = {sum[1] + us, sum[2] + 1}
    end
  end
  return nil
end

local function begin_input()
  for n, sum in pairs(trims) do trims[n] = sum[1] / sum[2] end
  for _, side in ipairs({-1, 1}) do
    local _, short = mixed(function(control) return side * test.scale * (test.test.sizes[control] or 0) end)
    if short ~= nil then
      say("ADVISOR CANNOT BEGIN: output " .. short .. " lacks travel")
      enter("spent")
      return
    end
  end
  at, number = test.place or at, number + 1
  if test == order then order = nil end
  test.length_s = length_of(test)
  before = now_flown()
  latest_ms = 0
  enter("flying")
  say(string.format("ADVISOR BEGIN %d %s", number, test.test.name))
  send(mixed(function(control) return asked(control, 0) end))
end

local function steady()
  local now = now_flown()
  local why = blocked or trouble(before, now)
  if why == "switch" then
    enter("idle")
    return
  end
  if why == nil and math.abs(now.bank) > 0.5 * BANK_DEG then why = "bank" end
  if why == nil and math.abs(now.bank - before.bank) > STEADY_DEG then why = "bank not steady" end
  if why == nil and math.abs(now.pitch - before.pitch) > STEADY_DEG then why = "pitch not steady" end
  if why == nil and moved_stick(before, now, 0.5 * STICK_PERCENT) then why = "stick not still" end
  if why == nil and since(since_ms) >= STEADY_MS - TRIM_MS then why = add_trims() end
  if why ~= nil then
    wait_for(why)
  elseif since(since_ms) >= STEADY_MS then
    begin_input()
  end
end

local orders = {}         -- SCR_USER1 to 4: which input (0: end input -size), its size in deg, its unit in s, a counter
local counted = nil       -- counter of the newest order
for k = 1, 4 do
  orders[k] = Parameter()
  if not orders[k]:init("SCR_USER" .. k) then orders = nil break end
end

-- Counter of an order that is new, or nil. The advisor writes the counter last.
local function new_order()
  if orders == nil then return nil end
  local counter = orders[4]:get() or 0
  if counted == nil then counted = counter end
  return counter ~= counted and counter or nil
end

-- Take the order of the next input.
local function take_order()
  local counter = new_order()
  if counter == nil then return end
  counted = counter
  local which, size, unit, candidate = orders[1]:get(), orders[2]:get(), orders[3]:get(), nil
  for _, one in ipairs(INPUTS) do
    if one.which == which then candidate = one end
  end
  local control = candidate and candidate.moves[1]
  if candidate == nil or #outputs[control] == 0 then
    say(string.format("ADVISOR REFUSES %d: no such input", counter))
  elseif size <= 0 or size > LARGEST_DEG[control] then
    say(string.format("ADVISOR REFUSES %d: size %.1f deg", counter, size))
  elseif candidate.steps and (unit < UNIT_S[1] or unit > UNIT_S[2]) then
    say(string.format("ADVISOR REFUSES %d: unit %.2f s", counter, unit))
  else
    order = {
      test = candidate, scale = size / candidate.sizes[control], counter = counter,
      unit_s = candidate.steps and unit or candidate.unit_s,
    }
    say_next()
  end
end

-- Take the order to end the multisine that is flown: its data are enough. Other orders wait for its end.
local function take_enough(t)
  local counter = new_order()
  if counter == nil or orders[1]:get() ~= 0 then return end
  counted = counter
  if test.test.sines == nil or orders[2]:get() ~= -number or t >= test.length_s then
    say(string.format("ADVISOR REFUSES %d: no multisine %.0f to end", counter, -orders[2]:get()))
    return
  end
  test.length_s, test.how = t, "done: enough"
  say(string.format("ADVISOR ENOUGH %d", counter))
end

local function fly(late_ms)
  local why = trouble(before, now_flown())
  latest_ms = math.max(latest_ms, late_ms)
  if why ~= nil then
    finish("aborted: " .. why)
    return
  end
  local t = 0.001 * since(since_ms)
  take_enough(t)
  if t >= test.length_s + test.test.rest_s then
    finish(test.how or "done")
  else
    -- A pulse holds until the next call: it gets the value of the middle of this time.
    local middle = t + 0.0005 * math.min(late_ms, LATE_MS)
    send(mixed(function(control) return asked(control, middle) end))
  end
end

local function step()
  local late_ms = since(called)
  called = millis()
  if phase == "flying" then
    fly(late_ms)
  elseif phase == "steady" then
    steady()
  else
    take_order()
    local us = switch_us()
    if us < END_US then
      if phase ~= "idle" then enter("idle") end
    elseif phase == "idle" and us > START_US then
      enter("up")
    elseif phase == "up" and since(since_ms) >= BOUNCE_MS then
      test = next_input()
      if test ~= nil then wait_for("steady flight") end
    end
  end
end

local function introduce()
  say(string.format("ADVISOR SCRIPT %s %s", AIRCRAFT, HASH))
  if blocked ~= nil then say("ADVISOR CANNOT FLY: " .. blocked) end
end

function update()
  local armed = arming:is_armed()
  if armed and not was_armed then introduce() end
  was_armed = armed
  step()
  return update, CALL_MS
end

local function compare()
  for name, value in pairs(PARAMETERS) do
    local now = param:get(name)
    if now ~= nil and math.abs(now - value) > 0.5 then
      say(string.format("ADVISOR %s is %.0f, in the log %.0f", name, now, value))
      return
    end
  end
end

phase = "spent"           -- a switch that is up while the script loads starts nothing
find_outputs()
for _, control in ipairs({"elevator", "aileron", "rudder"}) do
  if NEEDED[control] and #outputs[control] == 0 then say("ADVISOR no output of the " .. control) end
end
introduce()
compare()
say_next()
return update()
