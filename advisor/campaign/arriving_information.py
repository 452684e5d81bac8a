"""Information of the input being flown, at each whole second: the word that it is enough, before its end.

The samples up to a whole second after the begin count, once all channels have arrived. So a replay shows the
values of the flight.
"""

from math import floor

from advisor.campaign.state import LateralState
from advisor.decision.arriving import FIRST_S, Arriving
from advisor.decision.arriving_errors import arriving
from advisor.decision.verdict import FlightTestVerdict
from advisor.flight.elevator.elevator_watch import SETTLE_S
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate


class ArrivingInformation:
    """Computes the information of the input being flown once for each second."""

    def __init__(self) -> None:
        self._at: tuple[float, int] | None = None
        self._newest: Arriving | None = None

    def follow(
        self,
        flying: Maneuver | None,
        model: Estimate | None,
        flight_test: FlightTestVerdict,
        lateral: LateralState | None,
    ) -> Arriving | None:
        """Return the errors with the samples so far; None before the first oscillation and between inputs."""
        if flying is None:
            self._at, self._newest = None, None
            return None
        begun_s = flying.span.start_s
        seconds = floor(flying.span.end_s - SETTLE_S - begun_s)
        if seconds < FIRST_S:
            return None
        if self._at != (begun_s, seconds):
            self._at = begun_s, seconds
            side = (None, {}) if lateral is None else (lateral.model, _percent(lateral.flight_test))
            pitch = model, _percent(flight_test)
            self._newest = arriving(flying, begun_s + seconds, pitch, side)
        return self._newest


def _percent(verdict: FlightTestVerdict) -> dict[str, float | None]:
    """Return the error of each judged derivative, % of its tolerance."""
    progress = verdict.by_rule.get("information")
    return {} if progress is None else dict(progress.parameter_percent)
