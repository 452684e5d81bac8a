"""States of a campaign, changed on one axis."""

from dataclasses import fields, replace
from typing import Any

from advisor.campaign.state import AxisState, CampaignState

_OF_AN_AXIS = {field.name for field in fields(AxisState)}


def changed(state: CampaignState, lateral: AxisState[Any] | None = None, **changes: Any) -> CampaignState:
    """Return the state with changes of the elevator's axis, of roll and yaw, and of what no axis has."""
    of_pitch = {name: changes.pop(name) for name in _OF_AN_AXIS & changes.keys()}
    axes = {**state.axes, "pitch": replace(state.axes["pitch"], **of_pitch)}
    if lateral is not None:
        axes["lateral"] = lateral
    return replace(state, axes=axes, **changes)
