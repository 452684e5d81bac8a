"""``advisor gap`` of both axes: the diagnoses of pitch and of roll and yaw in one answer."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import click

from advisor.analysis.axes.side_comparison import AxisFlown, SideCompared
from advisor.campaign.hand_decisions import ByHand
from advisor.cli.axes.lateral_gap import diagnosed_lateral, lateral_answer, proved_lateral
from advisor.cli.axes.pitch_gap import diagnosed_pitch, pitch_answer
from advisor.cli.gap_asked import AxisAnswer, GapAsked, Unanswered
from advisor.exports.models.axes.handed_over import improved_side
from advisor.exports.models.flown import SideModel
from advisor.gap.result import IMPROVING

_HEADING = "\nRoll and yaw"


def compare_both(
    asked: GapAsked, by_hand: Sequence[ByHand], holdout: int | None, everything: bool, flown: AxisFlown | None
) -> int:
    """Diagnose both axes, print the results and write the files. An axis without an answer says why.

    Parameters
    ----------
    flown
        The flight, if the logs are already read.
    """
    state = flown.state if flown is not None else None
    pitch = diagnosed_pitch(asked, by_hand, holdout, flown.elevator if flown is not None else None)
    side = diagnosed_lateral(asked, state)
    if isinstance(side, Unanswered):
        if isinstance(pitch, Unanswered):
            return asked.refused(pitch, side)
        click.echo(f"Roll and yaw: {side.said}", err=True)
        answer = pitch_answer(asked, by_hand, everything, pitch, lambda: None)
        return asked.answered(_beside(answer, side))
    proved, proof = proved_lateral(asked, side)
    if isinstance(pitch, Unanswered):
        click.echo(f"Pitch: {pitch.said}", err=True)
        return asked.answered(_beside(lateral_answer(asked, proved, proof), pitch))
    ours = pitch_answer(
        asked, by_hand, everything, pitch, lambda: _side_model(proved), proved.gap.verdict in IMPROVING
    )
    beside = replace(asked, figure=_named_lateral(asked))
    theirs = lateral_answer(beside, proved, proof, writes=False)
    return asked.answered(_joined(ours, theirs), replace(theirs, show=lambda: _show(theirs)))


def _side_model(compared: SideCompared) -> SideModel | None:
    return improved_side(compared).side


def _joined(ours: AxisAnswer, theirs: AxisAnswer) -> AxisAnswer:
    """Return the answer of pitch with the document of both axes."""
    document: dict[str, Any] = {**ours.document, "lateral": theirs.document["lateral"]}
    document["lateral"]["improved_model"] = ours.document["improved_model"]
    document["problems"] = [*ours.document["problems"], *theirs.document["problems"]]
    return replace(ours, document=document)


def _beside(answer: AxisAnswer, other: Unanswered) -> AxisAnswer:
    """Return an answer whose document names the problems of the other axis."""
    problems = [*answer.document["problems"], *other.document["problems"]]
    return replace(answer, document={**answer.document, "problems": problems})


def _show(answer: AxisAnswer) -> None:
    click.echo(_HEADING)
    answer.show()


def _named_lateral(asked: GapAsked) -> Any:
    """Return the file for the picture of roll and yaw, next to that of pitch; None without a picture."""
    figure = asked.figure
    return None if figure is None else figure.with_stem(f"{figure.stem}-lateral")
