"""How many times faster than real time the bundled aircraft flies and writes its log, on one core (CPU time).

python benchmarks/simulator.py
"""

import time
from io import BytesIO

from sim.effects.fitting import flight_of
from sim.record import write_tlog
from sim.scenario import Noise, Scenario

FLIGHTS = {
    "uav, nonlinear, 500 Hz": Scenario(),
    "uav with five effects": Scenario(
        noise=Noise(percent=1.0),
        effects={
            "transport_delay": {},
            "actuator_backlash": {},
            "turbulence": {},
            "alpha_lag": {},
            "alpha_skew": {},
        },
    ),
    "light aircraft": Scenario(aircraft="light"),
    "paper's linear model": Scenario(aircraft="linear"),
    "JSBSim c172p": Scenario(engine="jsbsim", aircraft="c172p", height_m=1000.0),
}


def main() -> None:
    """Print one row a flight."""
    print(f"{'flight':28s} {'simulated':>10s} {'CPU':>7s} {'x real time':>12s} {'messages/s':>11s}")
    for name, scenario in FLIGHTS.items():
        write_tlog(flight_of(scenario), BytesIO())  # compiled and warm
        began = time.process_time()
        flight = flight_of(scenario)
        count = write_tlog(flight, BytesIO())
        spent = time.process_time() - began
        ratio, each = flight.duration_s / spent, count / spent
        print(f"{name:28s} {flight.duration_s:8.0f} s {spent:5.2f} s {ratio:12.0f} {each:11.0f}")


if __name__ == "__main__":
    main()
