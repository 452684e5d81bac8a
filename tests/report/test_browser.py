"""The page in a real browser: it asks for nothing and overflows nowhere, on a screen and on a phone."""

import html
import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from advisor.report.page.blocks import Content
from advisor.report.page.render import page
from tests.campaign.states import changed
from tests.report.conftest import Reported

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
WIDTHS = (1280, 390)
pytestmark = pytest.mark.xdist_group("report")
_HARNESS = """<!DOCTYPE html><meta charset="utf-8"><body style="margin:0">
{frames}<script>
function looked(frame) {{
  const inside = frame.contentWindow, page = inside.document, width = frame.clientWidth;
  const named = e => e.tagName + " " + (e.id || e.textContent.slice(0, 40));
  const wide = [...page.body.querySelectorAll("*")]
    .filter(e => !e.closest("svg") || e.tagName === "svg")
    .filter(e => e.getBoundingClientRect().right > width + 0.5
      || e.clientWidth && e.scrollWidth > e.clientWidth + 1)
    .map(named);
  const cut = [...page.querySelectorAll("svg text")].filter(e => {{
    const t = e.getBoundingClientRect(), s = e.closest("svg").getBoundingClientRect();
    return t.width && (t.left < s.left - 2 || t.right > s.right + 2 || t.top < s.top - 2
      || t.bottom > s.bottom + 2);
  }}).map(named);
  return {{
    width: inside.innerWidth, wide, cut, figures: page.querySelectorAll("svg").length,
    loaded: inside.performance.getEntriesByType("resource").map(entry => entry.name),
    least_height: Math.min(...[...page.querySelectorAll("svg")]
      .filter(e => e.checkVisibility()).map(e => e.getBoundingClientRect().height)),
    layers: [...page.querySelectorAll("select")].map(select => [...select.options].map(option => {{
      select.value = option.value;
      return [...page.querySelectorAll("[class^=layer-]")]
        .filter(e => e.getBoundingClientRect().width).map(e => e.getAttribute("class"));
    }})),
    seen: [...page.querySelectorAll(".broad, .narrow")].filter(e => e.checkVisibility())
      .map(e => e.className),
  }};
}}
addEventListener("load", () => {{
  const found = [...document.querySelectorAll("iframe")].map(looked);
  document.body.innerHTML = "";
  document.body.append(Object.assign(document.createElement("pre"), {{textContent: JSON.stringify(found)}}));
}});
</script>"""


def opened(page: str, folder: Path) -> list[dict[str, Any]]:
    """What a browser makes of a page at each width."""
    source = html.escape(page, quote=True)
    frames = "".join(
        f'<iframe style="width:{width}px;height:900px;border:0" srcdoc="{source}"></iframe>'
        for width in WIDTHS
    )
    harness = folder / "harness.html"
    harness.write_text(_HARNESS.format(frames=frames), encoding="utf-8")
    assert BROWSER is not None
    words = [
        BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking",
        f"--user-data-dir={folder / 'profile'}", "--virtual-time-budget=10000", "--dump-dom",
        harness.as_uri(),
    ]  # fmt: skip
    dom = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60).stdout
    found = re.search(r"<pre>(.*)</pre>", dom, re.DOTALL)
    assert found is not None
    seen: list[dict[str, Any]] = json.loads(html.unescape(found.group(1)))
    return seen


@pytest.mark.skipif(BROWSER is None, reason="Debian's chromium is not installed")
def test_the_page_asks_for_nothing_and_overflows_nowhere(reported: Reported, tmp_path: Path) -> None:
    seen = opened(reported.written, tmp_path)
    assert [one["width"] for one in seen] == list(WIDTHS)
    for one in seen:
        assert one["loaded"] == []
        assert one["wide"] == []
        assert one["cut"] == []
        assert one["figures"] > 10
        assert one["least_height"] > 60.0
    assert [set(one["seen"]) for one in seen] == [{"broad"}, {"narrow"}]


def printed_pages(page: str, folder: Path) -> int:
    """Count the pages that a browser prints on A4."""
    assert BROWSER is not None
    (folder / "page.html").write_text(page, encoding="utf-8")
    words = [
        BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking",
        f"--user-data-dir={folder / 'profile'}", "--no-pdf-header-footer",
        f"--print-to-pdf={folder / 'page.pdf'}", (folder / "page.html").as_uri(),
    ]  # fmt: skip
    subprocess.run(words, capture_output=True, check=True, timeout=60)
    return len(re.findall(rb"/Type\s*/Page[^s]", (folder / "page.pdf").read_bytes()))


def repeated(content: Content, count: int) -> Content:
    """The flight with its manoeuvres flown again until there are so many."""
    judged, written = content.state.maneuvers, content.analysis["maneuvers"]
    again = [judged[k % len(judged)] for k in range(count)]
    numbered = [
        replace(one, maneuver=replace(one.maneuver, number=k)) for k, one in enumerate(again, start=1)
    ]
    maneuvers = [{**written[k % len(written)], "number": k + 1} for k in range(count)]
    verdict = content.analysis["flight_test"]
    by_rule = {
        rule: {**one, "history_percent": (list(one["history_percent"]) * count)[:count]}
        for rule, one in verdict["by_rule"].items()
    }
    analysis = {
        **content.analysis, "maneuvers": maneuvers, "flight_test": {**verdict, "by_rule": by_rule}
    }  # fmt: skip
    return replace(content, analysis=analysis, state=changed(content.state, maneuvers=tuple(numbered)))


@pytest.mark.study
@pytest.mark.skipif(BROWSER is None, reason="Debian's chromium is not installed")
def test_thirty_manoeuvres_print_on_at_most_twelve_pages(reported: Reported, tmp_path: Path) -> None:
    assert printed_pages(page(repeated(reported.content, 30), "html"), tmp_path) <= 12


@pytest.mark.skipif(BROWSER is None, reason="Debian's chromium is not installed")
def test_the_end_of_the_page_prints_in_two_columns_on_one_page(reported: Reported, tmp_path: Path) -> None:
    """Telemetry, assumptions and origin filled two pages, the right half of which was white."""
    end = re.sub(r"<main>.*?(<section id=\"telemetry\")", r"<main>\1", reported.written, flags=re.S)
    assert end.count("<section") == 3
    assert printed_pages(end, tmp_path) == 1


@pytest.mark.skipif(BROWSER is None, reason="Debian's chromium is not installed")
def test_the_verdict_and_the_picture_of_the_gap_print_on_one_page(reported: Reported, tmp_path: Path) -> None:
    first = re.sub(
        r"(<section id=\"verdict\".*?</section>).*</main>", r"\1</main>", reported.written, flags=re.S
    )
    assert first.count("<section") == 1
    assert "the one with the largest gap" in first
    sentence = (
        "TEST COMPLETE: the response is known, each named derivative too, and the newest was predicted."
    )
    long = re.sub(r'(<p class="verdict">)[^<]*', rf"\1{sentence} {sentence}", first)
    limited = long.replace('<div class="gallery">', f'<ul><li>{sentence}</li></ul><div class="gallery">')
    assert printed_pages(limited, tmp_path) == 1


@pytest.mark.skipif(BROWSER is None, reason="Debian's chromium is not installed")
def test_the_chosen_channel_alone_is_laid_over_the_flight(reported: Reported, tmp_path: Path) -> None:
    for one in opened(reported.written, tmp_path):
        ((nothing, *layers),) = one["layers"]
        assert nothing == []
        assert ["layer-q"] in layers
        assert all(len(shown) == 1 for shown in layers)
