"""The chart of flying qualities: its ellipse is the joint region of the two errors, its levels are drawn."""

from types import SimpleNamespace
from typing import Any, NoReturn

import numpy as np
import pytest

from advisor.model.mil_f_8785c import CATEGORIES
from advisor.oem.flying_qualities import flying_qualities
from advisor.report.page import render
from advisor.report.page.blocks import Paragraph, Section
from advisor.report.page.drawing import log_ticks, picture
from advisor.report.page.flying_qualities import ellipse, flying_chart
from advisor.report.qualities import qualities_document
from tests.oem.test_flying_qualities import HEAVY, THETA, TRUE, estimate, found


def document() -> dict[str, Any]:
    made = qualities_document(found(relative=0.02))
    assert made is not None
    return made


def test_the_ellipse_holds_95_percent_of_many_draws() -> None:
    rng = np.random.default_rng(3)
    centre = document()
    x, y = (np.log(curve) for curve in ellipse(centre))
    middle = np.log([centre["n_alpha"]["value"], centre["natural_frequency"]["value"]])
    drawn = THETA * (1.0 + 0.02 * rng.standard_normal((500, len(THETA))))
    one = [flying_qualities(estimate(theta), TRUE, HEAVY).qualities for theta in drawn]
    points = np.log([[q["n_alpha"].value, q["natural_frequency"].value] for q in one])
    # The ellipse is the image of a circle, whose points at 0 and 90 degrees are two conjugate radii.
    radii = np.column_stack([[x[0], y[0]], [x[45], y[45]]]) - middle[:, None]
    inside = np.linalg.norm(np.linalg.solve(radii, (points - middle).T), axis=0) < 1.0
    assert np.mean(inside) == pytest.approx(0.95, abs=0.03)


def test_the_ellipse_reaches_beyond_the_interval_of_each_quality_alone() -> None:
    made = document()
    for curve, name in zip(ellipse(made), ("n_alpha", "natural_frequency"), strict=True):
        low, high = made[name]["ci95"]
        assert curve.min() < low < made[name]["value"] < high < curve.max()


def test_the_chart_shows_every_category_next_to_the_damping() -> None:
    chart = flying_chart(document())
    assert chart is not None
    assert chart.narrow is not None
    for svg in (chart.svg(), chart.narrow()):
        for name in CATEGORIES:
            assert f">Category {name}<" in svg
        assert ">Damping<" in svg


def test_without_an_air_speed_there_is_no_chart() -> None:
    without = qualities_document(found(speed=None))
    assert without is not None
    assert without["correlation"] is None
    assert flying_chart(without) is None


def test_a_short_logarithmic_axis_has_more_labels_in_a_decade_than_a_long_one() -> None:
    assert log_ticks(16.0, 32.0) == [20.0, 30.0]
    assert log_ticks(20.0, 6000.0) == [20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0]
    assert log_ticks(1.0, 1e5) == [10.0**k for k in range(6)]


SOUND = Section("headline", "Headline", ())


def flight_picture(content: object) -> NoReturn:
    raise IndexError("stretch 600 of 600")


def test_a_section_that_fails_is_named_in_its_place_and_its_neighbours_stand(monkeypatch):
    content: Any = SimpleNamespace(state=SimpleNamespace(maneuvers=(), tested_sideways=None))
    monkeypatch.setattr(render, "_PARTS", (lambda _: SOUND, flight_picture, lambda _: SOUND))
    first, failed, last = render.sections(content)
    assert first is last is SOUND
    assert failed.title == "Flight picture"
    (said,) = failed.blocks
    assert isinstance(said, Paragraph)
    assert "page, flight picture (IndexError: stretch 600 of 600)" in said.text


def test_a_picture_that_fails_is_a_sentence_in_its_place() -> None:
    drawn = picture("fit <1>", 3.0, 2.0, flight_picture)()
    assert drawn.startswith('<p class="note">A fault of the advisor, not yours, ended this part: ')
    assert "picture fit &lt;1&gt; (IndexError: stretch 600 of 600)" in drawn


def test_a_fault_that_is_none_of_numbers_ends_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(content: object) -> NoReturn:
        raise TypeError("no number")

    content: Any = SimpleNamespace(state=SimpleNamespace(maneuvers=(), tested_sideways=None))
    monkeypatch.setattr(render, "_PARTS", (broken,))
    with pytest.raises(TypeError):
        render.sections(content)
