"""Prediction of the last accepted manoeuvre from the earlier manoeuvres."""

from collections.abc import Iterator, Mapping

import numpy as np
from matplotlib.figure import Figure as Drawing

from advisor.campaign.state import JudgedManeuver
from advisor.decision.history import CandidateManeuver
from advisor.decision.hold_out import FEWEST, PredictedOutput, predict_last
from advisor.oem.estimate import Estimate
from advisor.oem.surface import Servo
from advisor.report.page.blocks import Block, Figure, Gallery, Paragraph, section
from advisor.report.page.content import Content
from advisor.report.page.drawing import BLUE, GREY, ORANGE, picture
from advisor.words.quantities import CHANNELS, Quantity

_EXPLAINED = (
    "Manoeuvre {last} is held out: manoeuvres {before} predict its response. "
    "Trim and initial state are those of manoeuvre {last} itself. "
    "Grey: measured. Dark dashes: predicted, with the 95 % band due to the errors of the derivatives. "
    "Below: measured minus predicted. Dark: the band of the prediction. "
    "Light: the band that holds 95 % of the samples of a right prediction."
)


@section("prediction", "Prediction of a held-out manoeuvre")
def prediction(content: Content) -> Iterator[Block]:
    """Yield a picture of each output of the held-out manoeuvre."""
    accepted = [j for j in content.state.maneuvers if j.verdict.accepted]
    predicted = predict_last([_flown(judged, content) for judged in accepted])
    if not predicted:
        few = len(accepted) <= FEWEST
        yield Paragraph(
            f"A prediction needs at least {FEWEST + 1} accepted manoeuvres."
            if few
            else "The manoeuvres before the last do not determine every derivative, so there is no "
            "prediction."
        )
        return
    last = accepted[-1]
    before = ", ".join(str(judged.maneuver.number) for judged in accepted[:-1])
    yield Paragraph(_EXPLAINED.format(last=last.maneuver.number, before=before))
    yield Gallery(tuple(_figures(last, predicted)))


def _figures(last: JudgedManeuver, predicted: Mapping[str, PredictedOutput]) -> Iterator[Figure]:
    number, start_s = last.maneuver.number, last.maneuver.span.start_s
    for name, output in predicted.items():
        quantity = CHANNELS[name]
        svg = picture(f"predicted-{name}", 4.4, 2.7, _paint, output, quantity, start_s)
        widest = f"{output.half.max() * quantity.factor:.2g} {quantity.unit}"
        within = np.mean(np.abs(output.measured - output.predicted) <= output.half_of_samples)
        yield Figure(
            svg,
            f"Manoeuvre {number}, {quantity.symbol}: the largest half-width of the prediction's band is "
            f"{widest}; "
            f"{100.0 * within:.0f} % of the samples lie within the samples' band.",
            "half",
        )


def _flown(judged: JudgedManeuver, content: Content) -> CandidateManeuver:
    lag_s = judged.estimate.servo_lag_s if isinstance(judged.estimate, Estimate) else 0.0
    servo = Servo(lag_s, content.aircraft.elevator.delay_s or 0.0)
    return CandidateManeuver(judged.estimate, maneuver=judged.maneuver, servo=servo)


def _paint(drawing: Drawing, output: PredictedOutput, quantity: Quantity, start_s: float) -> None:
    above, below = drawing.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
    t, factor = output.t - start_s, quantity.factor
    predicted, half, half_of_samples = (
        values * factor for values in (output.predicted, output.half, output.half_of_samples)
    )
    above.plot(t, output.measured * factor, color=GREY, linewidth=1.8, label="measured")
    above.fill_between(
        t, predicted - half, predicted + half, facecolor="#8fb4d6", linewidth=0.0, label="95 % band"
    )
    above.plot(t, predicted, color=BLUE, linestyle=(0, (4, 1.5)), label="predicted")
    above.set_ylabel(quantity.label)
    above.legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=3)
    below.fill_between(t, -half_of_samples, half_of_samples, facecolor="#dfeaf4", linewidth=0.0)
    below.plot(t, output.measured * factor - predicted, color=ORANGE, linewidth=0.7)
    below.fill_between(t, -half, half, facecolor="#5b8fbf", linewidth=0.0, alpha=0.7, zorder=3)
    below.set(xlabel="time since the first step [s]", ylabel=f"error [{quantity.unit}]")
    drawing.align_ylabels([above, below])
