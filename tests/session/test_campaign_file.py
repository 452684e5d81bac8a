"""The file beside a recording that keeps how a flight test is advised."""

from pathlib import Path

import pytest

from advisor.session.campaign_file import CampaignFile, path_beside, read_campaign, write_campaign
from advisor.words.problems import ConfigurationError


def test_the_options_come_back_as_they_were_kept(tmp_path: Path) -> None:
    kept = CampaignFile("udpin:0.0.0.0:14550", "separate", 7, {"elevator": {"output": 3}})
    write_campaign(tmp_path / "flight.tlog", kept)
    assert read_campaign(tmp_path / "flight.tlog") == kept


def test_a_recording_without_options_has_none(tmp_path: Path) -> None:
    assert read_campaign(tmp_path / "flight.tlog") is None


@pytest.mark.parametrize(
    "text",
    [
        "rule: information",
        "master: 5",
        "master: a\nrule: mine",
        "master: a\ntarget_system: all",
        "master: a\nfurther: 1",
        "- master",
        "",
    ],
)
def test_what_the_advisor_would_not_write_is_refused_with_a_mend(tmp_path: Path, text: str) -> None:
    path_beside(tmp_path / "flight.tlog").write_text(text)
    with pytest.raises(ConfigurationError, match="give the options again"):
        read_campaign(tmp_path / "flight.tlog")
