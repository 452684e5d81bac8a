"""A third coding of the aircraft, for the tests of the gap alone.

The nonlinear longitudinal motion in body velocities u, w is integrated by Euler-Cromer at 0.5 ms, with one
physical switch per effect. It is neither the advisor's α, q form nor the simulator's code. Used to develop
and to test the diagnosis; it shares nothing with what it tests.
"""

from dataclasses import dataclass, field

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.process.compiled import kernel

H = 0.0005
G = 9.80665


@dataclass(frozen=True)
class Airframe:
    mass: float = 10.0
    iyy: float = 1.1
    area: float = 0.62
    chord: float = 0.30
    speed: float = 22.0
    cl0: float = 0.25
    cl_alpha: float = 5.1
    cl_q: float = 6.0
    cl_de: float = 0.35
    cd0: float = 0.035
    induced: float = 0.055
    cm_alpha: float = -0.75
    cm_q: float = -14.0
    cm_de: float = -1.05
    cm_alphadot: float = 0.0
    unit_s: float = 0.35
    amplitude_deg: float = 3.0


UAV = Airframe()
LIGHT_AIRCRAFT = Airframe(
    mass=1200.0, iyy=1900.0, area=16.0, chord=1.5, speed=55.0, cl0=0.28, cl_alpha=4.9, cl_q=5.0, cl_de=0.4,
    cd0=0.03, induced=0.05, cm_alpha=-0.9, cm_q=-13.0, cm_de=-1.2, unit_s=0.5, amplitude_deg=3.0,
)  # fmt: skip
# Order of the physical switches handed to the integrator, with their neutral values.
SWITCHES = {
    "lag": 0.0, "rate_limit": 1e9, "play": 0.0, "deadband": 0.0, "delay": 0.0,
    "de2": 0.0, "de3": 0.0, "cm_a2": 0.0, "cm_a3": 0.0, "thrust_arm": 0.0, "cm_alphadot": 0.0,
    "cl_a2": 0.0, "cl_a3": 0.0, "lift_lag": 0.0, "lift_lag_share": 0.0, "moment_lags": 0.0,
    "ice_t": 1e9, "ice": 0.0, "height": 1e9, "ground": 0.0,
    "vane_lag": 0.0, "vane_arm": 0.0, "mode_gain": 0.0, "mode_hz": 5.0, "acc_arm": 0.0,
    "hysteresis": 0.0, "q_square": 0.0, "extra_cm_lag": 0.0, "extra_cm": 0.0,
    "kink_at": 9.0, "kink_width": 0.02, "wash": 0.0, "before_lag": 0.0,
    "speed_power": 0.0, "power_from": 22.0, "beat": 0.0, "beat_hz": 1.3,
    "q_abs": 0.0, "cm_aq": 0.0, "tail_chords": 0.0, "change_t": 1e9, "cg_after": 0.0, "mass_after": 0.0,
    "bends_about": -9.0, "slosh": 0.0, "slosh_hz": 0.9, "stop_low": -9.0, "stop_high": 9.0,
    "ring_hz": 0.0, "ring_zeta": 0.2, "stall_at": 9.0, "stall_sharpness": 40.0,
    "lets_go_at": 9.0, "holds_below": -9.0, "lost_cl": 0.0, "bank": 0.0,
    "breaks_at": 0.0, "drags": 0.0, "moment_power": 0.0, "mode_attitude": 0.0, "cl_q_abs": 0.0,
}  # fmt: skip
_K = {name: i for i, name in enumerate(SWITCHES)}
(LAG, RATE, PLAY, DEAD, DELAY, DE2, DE3, CMA2, CMA3, TARM, CMAD, CLA2, CLA3, LLAG, LSHARE, MLAGS, ICET,
 ICE, HEIGHT, GROUND, VLAG, VARM, MGAIN, MHZ, AARM, HYST, QSQ, ECMLAG, ECM,
 KINK, KWIDTH, WASH, BEFORE, POWER, FROM, BEAT, BEATHZ, QABS, CMAQ, TAIL, CHANGET, CGAFTER,
 MASSAFTER, ABOUT, SLOSH, SLOSHHZ, LOWEST, HIGHEST, RINGHZ,
 RINGZETA, STALLAT, STALLS, LETSGO, HOLDS, LOST, BANK,
 BREAKS, DRAGS, MPOWER, MATT, CLQABS) = range(len(SWITCHES))  # fmt: skip


@kernel()
def _integrate(n, command, gust, thrust_wave, body, sw, phase, out):
    (mass, iyy, area, chord, speed, cl0, cla, clq, clde, cd0, induced, cma, cmq, cmde, cmad) = body
    rho = 1.225
    # Trim: α for lift = weight at level flight, thrust for drag, elevator taken as zero there.
    qs = 0.5 * rho * speed * speed * area
    # Mach number or bending wings: lift and moments go with another power of the speed than V².
    # In a turn with no sideslip the wing carries more, and the aircraft pitches all the time.
    sb, cb = np.sin(sw[BANK]), np.cos(sw[BANK])
    load, pitching = 1.0 / cb, G * sb * sb / (cb * speed)
    a0 = (
        load * mass * G / (qs * (speed / sw[FROM]) ** sw[POWER]) - cl0 - clq * pitching * chord / (2 * speed)
    ) / cla
    cm0 = -cma * a0 - cmq * pitching * chord / (2 * speed)
    trim_thrust = qs * (cd0 + induced * (load * mass * G / qs) ** 2)
    u, w, q, th = speed * np.cos(a0), speed * np.sin(a0), pitching, np.arctan(np.tan(a0) * cb)
    de, link, lag_state, valve = 0.0, 0.0, 0.0, 0.0
    x_lift, vane = a0, a0
    eta, deta = 0.0, 0.0
    alphadot, height = 0.0, sw[HEIGHT]
    hyst, extra, met = 0.0, 0.0, 0.0
    fuel, flow, turned_at = 0.0, 0.0, 0.0
    rung, rung_rate = 0.0, 0.0
    separated, sliding = False, 0.0
    shift = round(sw[DELAY] / H)
    for k in range(n):
        t = k * H
        if t - H < sw[CHANGET] <= t:
            cma *= 1.0 + sw[CGAFTER]
            mass *= 1.0 + sw[MASSAFTER]
            iyy *= 1.0 + sw[MASSAFTER]
        want = command[max(k - shift, 0)]
        if sw[DEAD] > 0.0:
            want = np.sign(want) * max(abs(want) - sw[DEAD], 0.0)
        # A servo of second order, critically damped where both lags are alike.
        valve += H * (want - valve) / max(sw[BEFORE], H)
        speed_wanted = ((valve if sw[BEFORE] > 0.0 else want) - lag_state) / max(sw[LAG], H)
        lag_state += H * min(max(speed_wanted, -sw[RATE]), sw[RATE])
        if sw[BREAKS] > 0.0:
            # Dry friction: a position loop that breaks loose, and is dragged on while it slides.
            error = want - link
            if sliding == 0.0 and abs(error) > sw[BREAKS]:
                sliding = np.sign(error)
            pulled = sliding * error - sw[DRAGS]
            if pulled <= 0.0:
                sliding = 0.0
            else:
                link += H * sliding * pulled / max(sw[LAG], H)
        elif lag_state - link > sw[PLAY]:
            link = lag_state - sw[PLAY]
        elif lag_state - link < -sw[PLAY]:
            link = lag_state + sw[PLAY]
        rung_rate += (
            H
            * (2 * np.pi * sw[RINGHZ])
            * (2 * np.pi * sw[RINGHZ] * (link - rung) - 2 * sw[RINGZETA] * rung_rate)
        )
        rung += H * rung_rate
        de = min(max(rung if sw[RINGHZ] > 0.0 else link, sw[LOWEST]), sw[HIGHEST])
        wa = w + gust[k]
        V = np.sqrt(u * u + wa * wa)
        a = np.arctan2(wa, u)
        qb = 0.5 * rho * V * V * area
        x_lift += H * (a - x_lift) / max(sw[LLAG], 10 * H)
        ae = a - sw[LSHARE] * (a - x_lift)
        # What bends with α bends about the trim of this very speed, or about one angle.
        about = sw[ABOUT] if sw[ABOUT] > -1.0 else a0
        da, d0 = ae - about, a0 - about
        db = a - about
        ice = sw[ICE] if t > sw[ICET] else 0.0
        near = sw[GROUND] * np.exp(-height / (6.0 * chord))
        hyst += H * (a - hyst) / 0.4
        extra += H * (de - extra) / max(sw[ECMLAG], 10 * H)
        thrust = trim_thrust * (1.0 + thrust_wave[k])
        # The tail stands in the propeller's wash: thrust over the disk adds to its dynamic pressure.
        wash = 1.0 + sw[WASH] * (thrust / trim_thrust * (speed / V) ** 2 - 1.0)
        # Kirchhoff's flow: the part of the wing along which it is attached.
        attached = 0.5 * (1.0 - np.tanh(sw[STALLS] * (ae - sw[STALLAT])))
        # Flow that lets go at one angle and comes back at a lower one.
        separated = a > sw[LETSGO] or (separated and a > sw[HOLDS])
        cl = (
            cl0
            - sw[LOST] * separated
            + cla * (1.0 - ice) * (1.0 + near) * ae * (0.5 * (1.0 + np.sqrt(attached))) ** 2
            + sw[CLA2] * (da * da - d0 * d0)
            + sw[CLA3] * (da**3 - d0**3)
            + clq * q * chord / (2 * V)
            + sw[CLQABS] * abs(q)
            + clde * (1 - 0.5 * ice) * de
            - 0.7 * cla * sw[KWIDTH] * np.log1p(np.exp((a - sw[KINK]) / sw[KWIDTH]))
        )
        # The tail, so many chords behind, meets the gust later; its slope is what the damping says.
        met += H * (gust[k] - met) * V / max(sw[TAIL] * chord, 10 * H * V)
        turned = -cmq / (2.0 * sw[TAIL]) * (gust[k] - met) / V if sw[TAIL] > 0.0 else 0.0
        beyond = (V / sw[FROM]) ** sw[POWER]
        cl *= beyond
        cd = cd0 + induced * cl * cl + 3.0 * ice * cd0
        cm = (beyond * (V / sw[FROM]) ** sw[MPOWER]) * (
            cm0
            + cma * (1.0 - 0.6 * ice) * (a - sw[MLAGS] * (a - ae))
            + sw[CMA2] * (db * db - d0 * d0)
            + sw[CMA3] * (db**3 - d0**3)
            + (cmq * q + (cmad + sw[CMAD]) * alphadot) * chord / (2 * V)
            + wash * cmde * (1 - 0.5 * ice) * (de + sw[DE2] * de * de + sw[DE3] * de**3)
            - 0.4 * near
            + sw[HYST] * (a - hyst)
            + sw[QSQ] * q * abs(q)
            + sw[QABS] * abs(q)
            + sw[CMAQ] * (a - a0) * q * chord / (2 * V)
            + sw[ECM] * (extra - de)
            + turned
            - sw[SLOSH] * fuel
            + sw[BEAT] * np.sin(2 * np.pi * sw[BEATHZ] * t + phase)
        )
        # Fuel that pitching sets swinging, hardly damped.
        flow += (q - turned_at) - H * (2 * np.pi * sw[SLOSHHZ]) * (
            2 * np.pi * sw[SLOSHHZ] * fuel + 0.06 * flow
        )
        fuel += H * flow
        turned_at = q
        lift, drag = qb * cl, qb * cd
        fx = -drag * np.cos(a) + lift * np.sin(a) + thrust
        fz = -drag * np.sin(a) - lift * np.cos(a)
        ax, az = fx / mass, fz / mass
        qdot = (qb * chord * cm + sw[TARM] * trim_thrust * thrust_wave[k]) / iyy
        om = 2 * np.pi * sw[MHZ]
        deta += H * (om * om * (sw[MGAIN] * de - eta) - 2 * 0.05 * om * deta)
        eta += H * deta
        if sw[VLAG] > 0.0:
            vane += H * (a - sw[VARM] * q / V - vane) / sw[VLAG]
        else:
            vane = a - sw[VARM] * q / V
        out[0, k], out[1, k], out[2, k] = vane, q + deta / om, az - sw[AARM] * qdot
        # An attitude that is integrated from this gyro has what it turned by in it.
        out[3, k] = th + sw[MATT] * eta / om
        r = G * np.cos(th) * sb / u
        out[4, k], out[5, k], out[6, k], out[7, k] = V, ax, u * np.sin(th) - w * np.cos(th) * cb, de
        out[8, k] = r
        udot = ax - q * w - G * np.sin(th)
        wdot = az + q * u + G * np.cos(th) * cb
        alphadot = (wdot * u - w * udot) / (u * u + w * w)
        u += H * udot
        w += H * wdot
        q += H * qdot
        th += H * (q * cb - r * sb)
        height += H * out[6, k]


@dataclass(frozen=True)
class Setup:
    """One case: what is true of the aircraft and of its instruments."""

    airframe: Airframe = UAV
    switches: dict[str, float] = field(default_factory=dict)
    alpha_scale: float = 0.0
    alpha_bias: float = 0.0
    q_bias: float = 0.0
    q_scale: float = 0.0
    skew: dict[str, float] = field(default_factory=dict)
    attitude_brings_q: bool = False
    """Pitch rate and attitude in one message, with the same stamps."""
    thrust_amplitude: float = 0.0
    thrust_moves_in: tuple[int, ...] = tuple(range(9))
    """Manoeuvres, counted from 0, in which the throttle moves."""
    engine_lag_s: float = 0.0
    """Of the thrust behind the throttle."""
    surge: float = 0.0
    """Relative amplitude of thrust that surges without a command; no throttle shows it ..."""
    surge_hz: float = 0.6
    """... so many times a second."""
    logs_throttle: bool = False
    """Also where nobody moves it."""
    banks_deg: tuple[float, ...] = ()
    """Bank in which each manoeuvre is flown, in turn; none: wings level."""
    heights_m: tuple[float, ...] = ()
    """Height of each manoeuvre above ground, in turn, and logged; none: far above it."""
    gust_std: float = 0.0
    gust_pulse: float = 0.0
    wake: bool = False
    """A pulse is followed by its opposite, as behind a wing tip."""
    wave_m_s: float = 0.0
    wave_s: float = 3.0
    """Air that rises and sinks all the time: how fast, and its period."""
    cg_drift: float = 0.0
    """Relative change of Cm_α from first to last manoeuvre."""
    cg_step: float = 0.0
    """Relative change of Cm_α halfway."""
    cg_course: tuple[float, ...] = ()
    """Relative change of Cm_α by manoeuvre, in turn; none: ``cg_drift`` and ``cg_step`` apply."""
    mass_step: float = 0.0
    """Relative change of mass and inertia halfway."""
    inertia_of_mass: float = 1.0
    """Relative change of the inertia over that of the mass."""
    comes_at_s: float = 0.0
    """The steps of centre of gravity and mass come that much into the record halfway."""
    ice_after: int = 99
    noise: float = 0.01
    coloured: float = 0.0
    jitter: float = 0.0
    maneuvers: int = 9
    speed_change: float = 0.0
    rate_hz: float = 50.0
    seed: int = 0


def command_of(kind: int, unit: float, amplitude: float, t: np.ndarray, start: float) -> np.ndarray:
    """Return 3-2-1-1 with balanced areas, its reverse, or doublet, as a pilot's step input."""
    steps = {0: [(3, 0.8), (2, -1.0), (1, 1.1), (1, -1.5)], 1: [(3, -0.8), (2, 1.0), (1, -1.1), (1, 1.5)],
             2: [(2, 1.0), (2, -1.0)]}[kind]  # fmt: skip
    y, at = np.zeros_like(t), start
    for width, level in steps:
        y[(t >= at) & (t < at + width * unit)] = amplitude * level
        at += width * unit
    return y


def throttle_wave(setup: Setup, i: int, t: np.ndarray, start: float) -> np.ndarray:
    """Return the relative change of the throttle in a manoeuvre: opened for a second and a half."""
    moved = setup.thrust_amplitude if i in setup.thrust_moves_in else 0.0
    return moved * ((t > start + 1.5) & (t < start + 3.0))


def fly(setup: Setup, duration: float = 10.0) -> list[Maneuver]:
    """Fly the manoeuvres and return them as the segmenter would."""
    rng = np.random.default_rng(setup.seed)
    frame = setup.airframe
    n = int(duration / H)
    t = np.arange(n) * H
    result = []
    for i in range(setup.maneuvers):
        kind = (0, 1, 1, 0, 1, 0, 1, 0, 1)[i % 9]
        size = np.radians(frame.amplitude_deg) * (1.0, 1.0, 0.6, 1.0, 1.0, 0.6, 1.0, 1.0, 0.6)[i % 9]
        start = 1.0 + 0.02 * rng.random()
        command = command_of(kind, frame.unit_s, size, t, start)
        # A servo of 8 ms is not an effect but the hand that moves it.
        command = _soften(command, 0.008)
        sw = np.array([setup.switches.get(k, v) for k, v in SWITCHES.items()])
        sw[ICET] = 1e9 if i < setup.ice_after else -1.0
        if setup.heights_m:
            sw[HEIGHT] = setup.heights_m[i % len(setup.heights_m)]
        if setup.banks_deg:
            sw[BANK] = np.radians(setup.banks_deg[i % len(setup.banks_deg)])
        halfway = i >= setup.maneuvers // 2
        if setup.comes_at_s and i == setup.maneuvers // 2:
            halfway = False
            sw[CHANGET], sw[CGAFTER], sw[MASSAFTER] = setup.comes_at_s, setup.cg_step, setup.mass_step
        heavier = setup.mass_step if halfway else 0.0
        moved = setup.cg_drift * i / max(setup.maneuvers - 1, 1) + setup.cg_step * halfway
        moved = setup.cg_course[i] if setup.cg_course else moved
        cm_alpha = frame.cm_alpha * (1.0 + moved)
        body = (
            frame.mass * (1.0 + heavier), frame.iyy * (1.0 + setup.inertia_of_mass * heavier),
            frame.area, frame.chord,
            frame.speed * (1.0 + setup.speed_change * rng.uniform(-1, 1)), frame.cl0, frame.cl_alpha,
            frame.cl_q, frame.cl_de, frame.cd0, frame.induced, cm_alpha, frame.cm_q, frame.cm_de,
            frame.cm_alphadot,
        )  # fmt: skip
        wave = throttle_wave(setup, i, t, start)
        if setup.engine_lag_s:
            wave = _soften(wave, setup.engine_lag_s)
        wave = wave + setup.surge * np.sin(2 * np.pi * setup.surge_hz * t + i)
        gust = _dryden(rng, n, setup.gust_std, body[4])
        if setup.gust_pulse and i % 3 == 1:
            at = start + rng.uniform(0.5, 5.0)
            inside = (t > at) & (t < at + 0.8)
            gust = gust + setup.gust_pulse * 0.5 * (1 - np.cos(2 * np.pi * (t - at) / 0.8)) * inside
            if setup.wake:
                gust = gust - np.interp(t - 0.8, t, gust)
        if setup.wave_m_s:
            gust = gust + setup.wave_m_s * np.sin(2 * np.pi * t / setup.wave_s + 2.1 * i)
        out = np.zeros((9, n))
        _integrate(n, command, gust, wave, body, sw, 2.4 * i, out)
        result.append(_measure(setup, rng, i, t, command, out, start))
    return result


def _soften(y: np.ndarray, tau: float) -> np.ndarray:
    from scipy.signal import lfilter

    a = np.exp(-H / tau)
    return np.asarray(lfilter([1 - a], [1, -a], y))


def _dryden(rng: np.random.Generator, n: int, std: float, speed: float) -> np.ndarray:
    from scipy.signal import lfilter

    if std == 0.0:
        return np.zeros(n)
    tau = 50.0 / speed
    a = np.exp(-H / tau)
    y = lfilter([std * np.sqrt(1 - a * a)], [1, -a], rng.standard_normal(n + int(3 * tau / H)))
    return np.asarray(y)[-n:]


def _measure(setup, rng, i, t, command, out, start) -> Maneuver:
    channels = {}
    boot = 80.0 + 30.0 * i

    def add(name, y, rate, noise, skew=0.0, brought_by=None):
        if brought_by is None:
            stamps = np.arange(0.003 + 0.9 / rate * rng.random(), t[-1] - 0.2, 1.0 / rate)
            if setup.jitter:
                stamps = stamps + rng.uniform(-setup.jitter, setup.jitter, len(stamps))
                stamps = np.sort(np.clip(stamps, 0.0, t[-1]))
        else:
            stamps = channels[brought_by].t - boot
        true = np.interp(np.clip(stamps - skew, 0.0, t[-1]), t, y)
        e = rng.standard_normal(len(stamps))
        if setup.coloured:
            for k in range(1, len(e)):
                e[k] = setup.coloured * e[k - 1] + np.sqrt(1 - setup.coloured**2) * e[k]
        channels[name] = Channel(
            name, boot + stamps, true + noise * e, "generator", "vane" if name == "alpha" else "measured"
        )

    # Noise in per cent of each channel's usual peak.
    peak = {
        "alpha": np.max(np.abs(out[0] - out[0][0])),
        "q": np.max(np.abs(out[1])),
        "a_z": np.max(np.abs(out[2] - out[2][0])),
        "theta": np.max(np.abs(out[3] - out[3][0])),
    }
    rate = setup.rate_hz
    add(
        "alpha",
        (1 + setup.alpha_scale) * out[0] + setup.alpha_bias,
        rate,
        setup.noise * peak["alpha"],
        setup.skew.get("alpha", 0),
    )
    add(
        "q",
        (1 + setup.q_scale) * out[1] + setup.q_bias,
        rate,
        setup.noise * peak["q"],
        setup.skew.get("q", 0),
    )
    add("a_z", out[2], rate, setup.noise * peak["a_z"], setup.skew.get("a_z", 0))
    add(
        "theta",
        out[3],
        rate,
        setup.noise * peak["theta"] * 0.5,
        setup.skew.get("theta", 0),
        brought_by="q" if setup.attitude_brings_q else None,
    )
    add("a_x", out[5], rate, 0.03)
    add("airspeed", out[4], 10.0, 0.1)
    add("climb_rate", out[6], 10.0, 0.05)
    add("elevator", command, rate, 0.0)
    if setup.banks_deg:
        bank = np.radians(setup.banks_deg[i % len(setup.banks_deg)])
        add("bank", np.full(len(t), bank), rate, 0.002)
        add("r", out[8], rate, 0.002)
    if setup.heights_m:
        height = setup.heights_m[i % len(setup.heights_m)] + np.cumsum(out[6]) * H
        add("height", height, 10.0, 0.02)
    if setup.thrust_amplitude or setup.logs_throttle:
        add("throttle", 0.4 * (1 + throttle_wave(setup, i, t, start)), rate, 0.0)
    span = Span(boot, boot + start, boot + start + 2.4, boot + t[-1] - 0.2, "3-2-1-1", (), "quiet")
    return Maneuver(i + 1, 0, span, channels, "MANUAL")
