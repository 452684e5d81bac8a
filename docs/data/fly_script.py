"""Fly the inputs of inflight.lua in ArduPlane: python fly_script.py INPUTS FLIGHT.tlog [PORT].

ArduPlane runs in software in the loop on tcp port 5760, or PORT, and has the script in its folder `scripts`.
"""

import struct
import sys
import time

from pymavlink import mavutil

RATES = {"ATTITUDE": 50, "AOA_SSA": 50, "RAW_IMU": 50, "SERVO_OUTPUT_RAW": 50, "VFR_HUD": 50}
TAKEN_OFF_M, UP_M, SWITCH = 45.0, 80.0, 7
port = sys.argv[3] if len(sys.argv) > 3 else "5760"
link = mavutil.mavlink_connection(
    f"tcp:127.0.0.1:{port}", source_system=255, dialect="ardupilotmega", retries=60
)
heard = {"text": "", "mode": "", "height_m": 0.0, "boot_s": 0.0, "throttle_us": 1500.0, "pitch_us": 1500.0}
STICK_US_PER_RAD = 500.0 / 0.436  # full stick asks for PTCH_LIM_MAX_DEG, 25 deg


def listen(log, until, limit_s, pulses=None):
    """Write all messages to the log until a condition holds; hold RC pulses, and fail after limit_s."""
    ends = heard["boot_s"] + limit_s
    sent_s = 0.0
    while not until():
        message = link.recv_match(blocking=True, timeout=60)
        if message is None or heard["boot_s"] > ends:
            sys.exit(f"waited for more than {limit_s} s; the last text was: {heard['text']}")
        log.write(struct.pack(">Q", int(time.time() * 1e6)) + message.get_msgbuf())
        kind = message.get_type()
        if kind == "STATUSTEXT":
            heard["text"] = message.text
        elif kind == "HEARTBEAT":
            heard["mode"] = mavutil.mode_string_v10(message)
        elif kind == "GLOBAL_POSITION_INT":
            heard["height_m"] = message.relative_alt / 1000.0
        elif kind == "SERVO_OUTPUT_RAW":
            heard["throttle_us"] += 0.01 * (message.servo3_raw - heard["throttle_us"])
        elif kind == "ATTITUDE":
            heard["boot_s"] = message.time_boot_ms / 1000.0
            heard["pitch_us"] += 0.01 * (1500.0 + STICK_US_PER_RAD * message.pitch - heard["pitch_us"])
            if pulses and abs(heard["boot_s"] - sent_s) > 0.1:
                sent_s = heard["boot_s"]
                link.mav.rc_channels_override_send(1, 1, *pulses)


def change_mode(log, mode, pulses):
    """Change the flight mode, and wait for the vehicle's word."""
    link.set_mode(mode)
    listen(log, lambda: heard["mode"] == mode, 30.0, pulses)


def after(seconds):
    """Return a condition that holds after a time."""
    ends = heard["boot_s"] + seconds
    return lambda: heard["boot_s"] >= ends


def sticks(switch_us, pitch_us=1500, throttle_us=1500):
    """Return the sticks, and the switch of the script."""
    pulses = [1500, round(pitch_us), round(throttle_us), 1500, 0, 0, 0, 1800]
    pulses[SWITCH - 1] = switch_us
    return pulses


with open(sys.argv[2], "wb") as log:
    link.wait_heartbeat(timeout=120)
    for name, rate_hz in RATES.items():
        number = getattr(mavutil.mavlink, f"MAVLINK_MSG_ID_{name}")
        link.mav.command_long_send(1, 1, 511, 0, number, 1e6 / rate_hz, 0, 0, 0, 0, 0)
    link.mav.request_data_stream_send(1, 1, mavutil.mavlink.MAV_DATA_STREAM_POSITION, 5, 1)
    link.mav.param_request_list_send(1, 1)
    listen(log, lambda: "is using GPS" in heard["text"], 120.0, sticks(1000))
    change_mode(log, "TAKEOFF", sticks(1000))
    link.mav.command_long_send(1, 1, 400, 0, 1, 21196, 0, 0, 0, 0, 0)
    listen(log, lambda: heard["height_m"] > TAKEN_OFF_M, 120.0, sticks(1000))
    change_mode(log, "CRUISE", sticks(1000, pitch_us=1800))
    listen(log, lambda: heard["height_m"] > UP_M, 120.0, sticks(1000, pitch_us=1800))
    for number in range(int(sys.argv[1])):
        change_mode(log, "CRUISE", sticks(1000))
        listen(log, after(8.0), 20.0, sticks(1000))
        # FBWA flies on with the pitch and the throttle of level flight, which then stay where they are.
        level = {"pitch_us": heard["pitch_us"], "throttle_us": heard["throttle_us"]}
        change_mode(log, "FBWA", sticks(1000, **level))
        heard["text"] = ""
        listen(log, lambda: heard["text"].startswith("ADVISOR END"), 90.0, sticks(1900, **level))
        print(number + 1, heard["text"], flush=True)
        listen(log, after(4.0), 10.0, sticks(1000, **level))
