"""A link that cannot serve, over a real socket: said in text within seconds."""

import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.link import Link
from advisor.report.follow import follow
from tests.mavlink.link.test_peers import running


def test_a_slow_link_is_said_in_text_within_5_s_of_the_vehicles_first_message(tmp_path: Path) -> None:
    scenario = tmp_path / "slow.yaml"
    scenario.write_text("rates: {ATTITUDE: 4, AOA_SSA: 4, SERVO_OUTPUT_RAW: 4, RAW_IMU: 4, VFR_HUD: 4}\n")
    said: list[tuple[float, str]] = []
    with Link("udpin:127.0.0.1:0") as link:
        to = f"udpout:127.0.0.1:{link.port}"

        def batches() -> Iterator[list[Columns]]:
            give_up_s = time.monotonic() + 20.0
            while not any("NO DATA" in text for _, text in said):
                assert time.monotonic() < give_up_s, said
                yield link.read(0.1)

        with running("-m", "sim", "fly", "--master", to, "--scenario", str(scenario), folder=tmp_path):
            follow(batches(), Campaign(Aircraft()), lambda text: said.append((time.monotonic(), text)))
    found_s = next(at_s for at_s, text in said if text.startswith("following"))
    told_s, sentence = next((at_s, text) for at_s, text in said if text.startswith("NO DATA"))
    assert told_s - found_s < 5.0
    told = re.search(r"arrives at ([\d.]+) Hz", sentence)
    assert told is not None, sentence
    # The vehicle flies in real time, and a busy machine delays its messages.
    assert float(told[1]) == pytest.approx(4.0, abs=1.0)
    assert "--request-rates" in sentence
