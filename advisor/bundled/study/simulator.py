"""The parts of the bundled simulator that studies use, by the name under which a wheel installs them."""

from typing import TYPE_CHECKING

from advisor.process.installed import SIMULATOR

if TYPE_CHECKING or SIMULATOR == "sim":
    from sim.airframe import UAV
    from sim.hangar import AIRFRAMES
    from sim.linear import RESEARCH_JET, ShortPeriod
    from sim.maneuvers import STEPS
    from sim.nonlinear_aircraft import NonlinearAircraft
else:
    from inflight_sim.airframe import UAV
    from inflight_sim.hangar import AIRFRAMES
    from inflight_sim.linear import RESEARCH_JET, ShortPeriod
    from inflight_sim.maneuvers import STEPS
    from inflight_sim.nonlinear_aircraft import NonlinearAircraft

__all__ = ["AIRFRAMES", "RESEARCH_JET", "STEPS", "UAV", "NonlinearAircraft", "ShortPeriod"]
