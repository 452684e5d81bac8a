"""What a crew orders of a live link by a key: another vehicle, the elevator's output."""

import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.flight.maneuvers.maneuver import VehicleFound
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.link.link import Link
from advisor.mavlink.logs.logs import open_log
from advisor.report.text import follow
from tests.mavlink.link.builders import UdpVehicle, attitude, free_port, heartbeat, read_all, wait_until
from tests.mavlink.link.test_peers import running


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.fixture
def vehicles(port: int) -> Iterator[list[UdpVehicle]]:
    both = [UdpVehicle(port, system=1), UdpVehicle(port, system=2)]
    yield both
    for vehicle in both:
        vehicle.close()


def followed(batches: list[list[Columns]]) -> list[int]:
    stream = FlightStream(Aircraft())
    events = [event for batch in batches for event in stream.feed(batch)]
    return [event.vehicle.system for event in events if isinstance(event, VehicleFound)]


def read_until_followed(link: Link, vehicle: tuple[int, int]) -> list[list[Columns]]:
    """Read as a campaign does; whoever decodes the stream tells the link whom to listen to."""
    batches: list[list[Columns]] = []

    def read() -> bool:
        batches.append(link.read(0.01))
        return link.statistics.vehicle == vehicle

    wait_until(read)
    return batches


def test_the_link_the_campaign_and_the_recording_follow_the_vehicle_that_a_key_chose(
    port: int, vehicles: list[UdpVehicle], tmp_path: Path
) -> None:
    own = tmp_path / "own.tlog"
    with Link(f"udpin:127.0.0.1:{port}", record_to=own) as link:
        for vehicle in vehicles:
            vehicle.send(heartbeat(), attitude(1000))
            time.sleep(0.05)
        wait_until(lambda: link.statistics.vehicle == (1, 1))
        link.follow(2)
        live = read_until_followed(link, (2, 1))
        vehicles[1].send(attitude(1020))
        live.append(read_all(link))
    assert followed(live) == [1, 2]
    assert followed(list(open_log(own))) == [1, 2]


def test_to_follow_another_vehicle_sends_nothing(port: int, vehicles: list[UdpVehicle]) -> None:
    with Link(f"udpin:127.0.0.1:{port}") as link:
        for vehicle in vehicles:
            vehicle.send(heartbeat())
        wait_until(lambda: link.statistics.vehicle is not None)
        link.follow(2)
        read_until_followed(link, (2, 1))
        for vehicle in vehicles:
            vehicle.socket.settimeout(0.2)
            with pytest.raises(TimeoutError):
                vehicle.hear()


def test_a_passive_link_asks_for_the_outputs_when_a_key_says_so_and_for_nothing_else(port, vehicles):
    vehicle = vehicles[0]
    with Link(f"udpin:127.0.0.1:{port}") as link:
        vehicle.send(heartbeat())
        wait_until(lambda: link.statistics.vehicle == (1, 1))
        link.ask_for_outputs()
        asked = [vehicle.hear() for _ in range(10)]
    assert {message.get_type() for message in asked} == {"PARAM_REQUEST_READ"}
    assert {message.param_id for message in asked} == {f"SERVO{n}_FUNCTION" for n in range(1, 11)}


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
