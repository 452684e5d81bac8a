"""``advisor doctor`` as its users run it."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import Advisor
from tests.flights import calm_two
from tests.mavlink.link.builders import free_port

LOGS = Path(__file__).parents[2] / "logs"


def test_a_log_at_default_rates_ends_with_3_a_sentence_and_still_a_document(advisor: Advisor) -> None:
    run = advisor("doctor", LOGS / "arduplane-default-rates.tlog", "--json")
    assert run.returncode == 3
    document = json.loads(run.stdout)
    assert document["usable"] is False
    assert document["verdict"] == "not usable"
    assert {"code", "text", "fix"} <= document["problems"][0].keys()
    assert run.stderr.count("\n") == 1
    assert "arrives at 2.0 Hz" in run.stderr
    assert "Traceback" not in run.stderr


def test_a_usable_log_is_told_in_words_verdict_first(advisor: Advisor) -> None:
    run = advisor("doctor", calm_two())
    assert run.returncode == 0
    assert run.stderr == ""
    first, *rest = run.stdout.splitlines()
    assert "USABLE WITH LIMITS" in first
    told = "\n".join(rest)
    for word in ("output 2", "AOA_SSA", "derived", "ATTITUDE", "natural frequency", "M_α"):
        assert word in told


@pytest.mark.parametrize(
    ("target", "code", "word"),
    [
        ("no-such-flight.tlog", 3, "no-such-flight.tlog"),
        ("pigeon://coop:1", 2, "pigeon"),
        ("udpin:127.0.0.1:notaport", 2, "no port"),
    ],
)
def test_what_cannot_be_examined_is_refused_in_one_sentence(target, code, word, advisor):
    run = advisor("doctor", target)
    assert run.returncode == code
    assert word in run.stderr
    assert "Traceback" not in run.stderr


def test_a_silent_link_is_not_usable(advisor: Advisor) -> None:
    run = advisor("doctor", f"udpin:127.0.0.1:{free_port()}", "--seconds", "1", "--json")
    assert run.returncode == 3
    assert json.loads(run.stdout)["problems"][0]["code"] == "no_vehicle"


def test_before_the_flight_rates_are_asked_for_and_the_elevator_is_found(advisor, tmp_path):
    port = free_port()
    scenario = tmp_path / "slow.yaml"
    scenario.write_text("rates: {ATTITUDE: 4.0, AOA_SSA: 4.0, SERVO_OUTPUT_RAW: 2.0, HEARTBEAT: 1.0}\n")
    sim = [sys.executable, "-m", "sim", "fly", "--master", f"udpout:127.0.0.1:{port}"]
    process = subprocess.Popen(
        [*sim, "--scenario", str(scenario)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        run = advisor("doctor", f"udpin:127.0.0.1:{port}", "--seconds", "6", "--request-rates", "--json")
    finally:
        process.kill()
        process.communicate()
    document = json.loads(run.stdout)
    assert document["elevator"]["output"] == 2
    rates = {message["name"]: message["rate_hz"] for message in document["messages"]}
    assert rates["ATTITUDE"] > 40.0
    assert document["usable"] is True, document["problems"]
    assert run.returncode == 0
