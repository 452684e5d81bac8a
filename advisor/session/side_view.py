"""Roll and yaw in the place of the elevator's axis, for every pane that shows one axis."""

from dataclasses import replace
from typing import Any

from advisor.campaign.state import OF_ELEVATOR, JudgedLateral, JudgedManeuver, LateralState
from advisor.oem.estimate import NoEstimate
from advisor.session.view import View


class SideView:
    """Views of roll and yaw. The parts of a view stay identical objects until a manoeuvre is judged."""

    def __init__(self) -> None:
        self._of: LateralState | None = None
        self._parts: dict[str, Any] = {}

    def of(self, view: View) -> View:
        """Return the view with the manoeuvres, the verdicts and the estimate of roll and yaw; the same view
        where roll and yaw are not judged."""
        lateral = view.state.lateral
        if lateral is None:
            return view
        if lateral is not self._of:
            self._of, self._parts = lateral, _parts(lateral)
        others = tuple(problem for problem in view.state.no_data if problem.code not in OF_ELEVATOR)
        state = replace(view.state, **self._parts, **_IN_THE_AIR, no_data=others)
        problems = tuple(problem for problem in view.problems if problem.code not in OF_ELEVATOR)
        return replace(view, state=state, problems=problems, elevator=view)


_IN_THE_AIR: dict[str, Any] = {"flying": None, "settling": None, "readable": False, "enough": None}
"""State of a manoeuvre that is being flown, which is followed for the elevator alone."""


def _parts(lateral: LateralState) -> dict[str, Any]:
    return {
        "maneuvers": tuple(map(_judged, lateral.maneuvers)),
        "flight_test": lateral.flight_test,
        "model": lateral.model.estimate if lateral.model is not None else None,
        "estimate_from": lateral.estimate_from,
    }


def _judged(one: JudgedLateral) -> JudgedManeuver:
    found = one.estimate
    return JudgedManeuver(
        one.maneuver, found if isinstance(found, NoEstimate) else found.estimate, one.verdict
    )
