"""Whatever process dies, whatever the disk does: the flight is recorded, and its verdicts come."""

import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest

from tests.flights import SHIPPED, TWO, recorded
from tests.mavlink.link.air import Record, records_of
from tests.mavlink.link.builders import wait_until
from tests.mavlink.link.live import Advising, fly, kill, stand_still

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")

FLIGHT = records_of(SHIPPED / "bundled-demo.tlog")
VERDICT = re.compile(r"^ *\d+ +\d+:\d\d\.\d .*(ACCEPTED|REPEAT)")
SPEED = 4.0
OVERDUE = 0.05
"""Speed at which the flight goes on while a strike is overdue. The elevator's outputs then come 2.5 times a
second, so that the end of a gap is heard within the two seconds that the advisor takes it for its own."""
LAST_VERDICT_S = 300.0
"""Longest wait for the last verdict, s. A new estimator first catches up with the whole recording."""


@pytest.fixture
def advising(tmp_path: Path) -> Iterator[Advising]:
    advising = Advising(tmp_path, "--rule", "continuous")
    yield advising
    advising.clear()


def until(flight: Sequence[Record], seconds: float) -> list[Record]:
    return [record for record in flight if record.stamp_us - flight[0].stamp_us < seconds * 1e6]


def verdicts(lines: Sequence[str]) -> list[str]:
    return [line for line in lines if VERDICT.match(line)]


def analyzed(log: Path) -> list[str]:
    """Verdicts of ``advisor analyze``."""
    command = [sys.executable, "-m", "advisor", "analyze", str(log), "--rule", "continuous"]
    return verdicts(subprocess.run(command, capture_output=True, text=True).stdout.splitlines())


def survives(advising, flight, maneuvers, victims, speed, hang_s=None):
    """Fly while each victim in turn is struck, a random time after the one before is replaced.

    The flight goes on while a victim is replaced. It slows down when the next strike is due before that, so
    that every strike falls into the flight however busy the machine is.

    Parameters
    ----------
    hang_s
        Shortest and longest time for which a victim stands still. None: it is killed.
    """
    rng = np.random.default_rng()
    waiting = list(rng.permutation(victims))
    pause_s = (flight[-1].stamp_us - flight[0].stamp_us) / 1e6 / len(victims) / 2.0
    next_s = [rng.uniform(0.0, 2.0 * pause_s)]
    flown_s, hangs_until_s = [0.0], [0.0]

    def is_due() -> bool:
        return bool(waiting) and flown_s[0] >= next_s[0] and time.monotonic() >= hangs_until_s[0]

    def strike(now_s: float) -> None:
        flown_s[0] = now_s
        if not is_due() or not (advising.whole and advising.answers):
            return
        next_s[0] = now_s + rng.uniform(0.0, pause_s)
        victim = waiting.pop()
        assert advising.process is not None
        pid = {"screen": advising.process.pid, "narrator": advising.narrator}.get(victim, advising.keeper)
        if hang_s is not None:
            seconds = float(np.exp(rng.uniform(*np.log(hang_s))))
            hangs_until_s[0] = time.monotonic() + seconds
            stand_still(pid, seconds)
        elif victim == "screen":
            advising.kill()
            advising.launch("--resume", str(advising.recording))
        else:
            kill(pid)

    advising.start()
    fly(flight, advising.port, lambda: OVERDUE if is_due() else speed, strike)
    assert not waiting
    wait_until(lambda: len(verdicts(advising.said)) >= maneuvers, LAST_VERDICT_S)
    assert advising.end() == 130


def frames_missing(advising: Advising, flight: Sequence[Record]) -> int:
    recorded = {record.frame for record in records_of(advising.recording)}
    return sum(record.frame not in recorded for record in flight)


@pytest.mark.study
def test_each_process_may_die_once_and_no_verdict_is_missed(advising: Advising):
    flight = until(FLIGHT, 44.0)
    survives(advising, flight, 2, ["narrator", "screen", "keeper"], SPEED)
    assert verdicts(advising.said) == analyzed(advising.recording)
    assert all("ACCEPTED" in line for line in verdicts(advising.said))
    assert frames_missing(advising, flight) <= SPEED * len(flight) / 44.0


@pytest.mark.study
@pytest.mark.timeout(1800)
def test_fifty_deaths_at_random_moments_change_no_verdict(advising: Advising):
    survives(advising, FLIGHT, 7, ["narrator"] * 20 + ["screen"] * 20 + ["keeper"] * 10, 1.0)
    length_s = (FLIGHT[-1].stamp_us - FLIGHT[0].stamp_us) / 1e6
    assert verdicts(advising.said) == analyzed(advising.recording)
    assert all("ACCEPTED" in line for line in verdicts(advising.said))
    assert frames_missing(advising, FLIGHT) <= 10 * len(FLIGHT) / length_s


@pytest.mark.study
@pytest.mark.timeout(2400)
def test_fifty_hangs_at_random_moments_change_no_verdict(advising: Advising):
    """Hangs of half a second to 25 s: the longest are ended, the others end by themselves."""
    speed = 0.2
    survives(advising, FLIGHT, 7, ["narrator"] * 20 + ["screen"] * 20 + ["keeper"] * 10, speed, (0.5, 25.0))
    length_s = (FLIGHT[-1].stamp_us - FLIGHT[0].stamp_us) / 1e6
    assert verdicts(advising.said) == analyzed(advising.recording)
    assert frames_missing(advising, FLIGHT) <= 60.0 * speed * len(FLIGHT) / length_s
    why = [line.split("REPEAT: ")[1] for line in verdicts(advising.said) if "REPEAT" in line]
    assert {text.partition(" s ")[2] for text in why} <= {"are missing: the advisor was down; fly it again"}


def test_the_link_goes_on_recording_when_the_terminal_goes_away(advising: Advising):
    advising.start()
    flight = until(FLIGHT, 8.0)
    assert advising.end(signal.SIGHUP) == 129
    fly(flight, advising.port, SPEED, lambda now_s: None)
    wait_until(lambda: len(records_of(advising.recording)) == len(flight), 5.0)


@pytest.mark.study
def test_what_a_power_cut_leaves_of_a_recording_ends_less_than_a_second_before_it(advising: Advising):
    flight = until(FLIGHT, 8.0)
    advising.start()
    cut_s = [0.0]

    def cut(now_s: float) -> None:
        if now_s >= 6.0 and not cut_s[0]:
            cut_s[0] = now_s
            kill(advising.process.pid)
            kill(advising.keeper)

    fly(flight, advising.port, 1.0, cut)
    sent = until(flight, cut_s[0])
    left = records_of(advising.recording)
    last_s = (sent[len(left) - 1].stamp_us - flight[0].stamp_us) / 1e6
    assert [record.frame for record in left] == [record.frame for record in sent[: len(left)]]
    assert cut_s[0] - last_s < 1.0


def test_a_home_that_takes_no_file_keeps_nobody_from_advising(advising: Advising):
    advising.environment |= {"XDG_DATA_HOME": "/dev/null/data", "TMPDIR": str(advising.folder)}
    advising.start("--master", f"udpin:127.0.0.1:{advising.port}")
    wait_until(lambda: "recording to" in advising.warned)
    assert (
        "/dev/null/data/inflight-advisor/recordings takes no recording (Not a directory)" in advising.warned
    )
    flight = until(FLIGHT, 4.0)
    fly(flight, advising.port, SPEED, lambda now_s: None)
    wait_until(lambda: any("following" in line for line in advising.said), 30.0)
    assert advising.end() == 130
    (recording,) = advising.folder.glob("advisor-recordings-*/*.tlog")
    assert len(records_of(recording)) == len(flight)


def test_a_link_left_alone_records_until_a_new_flight_test_ends_it_and_says_how_to_resume(advising):
    advising.start()
    advising.kill()
    flight = until(FLIGHT, 8.0)
    fly(flight, advising.port, SPEED, lambda now_s: None)
    wait_until(lambda: len(records_of(advising.recording)) == len(flight), 5.0)
    assert advising.note_of_keeper()["alone"]
    other = advising.folder / "other.tlog"
    advising.start("--master", f"udpin:127.0.0.1:{advising.port}", "--record", str(other))
    assert f"--resume {advising.recording} continues its flight test" in advising.warned
    assert advising.end() == 130
    assert other.exists()


def test_a_lost_link_that_hangs_keeps_no_new_flight_test_from_its_connection(advising: Advising):
    advising.start()
    advising.kill()
    wait_until(lambda: bool(advising.note_of_keeper().get("alone")))
    hung = advising.keeper
    stand_still(hung, 60.0)
    other = advising.folder / "other.tlog"
    advising.start("--master", f"udpin:127.0.0.1:{advising.port}", "--record", str(other))
    wait_until(lambda: advising.keeper not in (None, hung))
    assert advising.end() == 130
    assert other.exists()


def test_a_full_disk_is_said_and_nothing_is_lost_when_there_is_room_again(advising: Advising):
    flight = until(FLIGHT, 12.0)
    full, room = (len(until(flight, at_s)) for at_s in (2.0, 7.0))
    advising.start()

    def limit(size: int) -> None:
        resource.prlimit(advising.keeper, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

    fly(flight[:full], advising.port, SPEED, lambda now_s: None)
    limit(advising.recording.stat().st_size)
    fly(flight[full:room], advising.port, SPEED, lambda now_s: None)
    wait_until(lambda: f"recording to {advising.recording} fails" in advising.warned, 30.0)
    limit(resource.RLIM_INFINITY)
    fly(flight[room:], advising.port, SPEED, lambda now_s: None)
    wait_until(lambda: "goes on: nothing is lost" in advising.warned, 10.0)
    wait_until(lambda: len(records_of(advising.recording)) == len(flight), 5.0)
    assert advising.end() == 130


@pytest.mark.study
def test_a_resumed_flight_test_keeps_its_connection_rule_and_decisions(advising: Advising):
    advising.start()
    fly(until(FLIGHT, 55.0), advising.port, 20.0, lambda now_s: None)
    wait_until(lambda: len(verdicts(advising.said)) == 2, 30.0)
    assert advising.end() == 130
    minutes, seconds = verdicts(advising.said)[0].split()[1].split(":")
    start_s = 60.0 * float(minutes) + float(seconds)
    decided = advising.recording.with_suffix(".maneuvers.yaml")
    decided.write_text(f"excluded:\n- {{at_s: {start_s}, because: a gust}}\n")
    advising.resume()
    wait_until(lambda: any("a gust" in line for line in advising.said), 30.0)
    wait_until(lambda: any("1 of 3 accepted manoeuvres" in line for line in advising.said), 30.0)
    fly(FLIGHT[len(until(FLIGHT, 40.0)) :], advising.port, 20.0, lambda now_s: None)
    wait_until(lambda: len(verdicts(advising.said)) == 6, 30.0)
    assert advising.end() == 130


def test_a_flight_test_goes_on_with_the_log_of_an_earlier_battery_and_leaves_it_alone(advising: Advising):
    earlier = recorded("linear", 2.5, maneuvers=TWO[:1])
    before = earlier.read_bytes()
    master = f"udpin:127.0.0.1:{advising.port}"
    advising.start("--resume", str(earlier), "--record", str(advising.recording), "--master", master)
    wait_until(lambda: len(verdicts(advising.said)) == 1, 30.0)
    flight = until(FLIGHT, 30.0)
    fly(flight, advising.port, 20.0, lambda now_s: None)
    wait_until(lambda: len(verdicts(advising.said)) == 2, 30.0)
    assert [int(line.split()[0]) for line in verdicts(advising.said)] == [1, 2]
    assert advising.end() == 130
    assert earlier.read_bytes() == before
    assert len(records_of(advising.recording)) == len(flight)


def test_without_a_recording_a_new_estimator_begins_anew(advising: Advising):
    advising.start("--master", f"udpin:127.0.0.1:{advising.port}", "--no-record")
    wait_until(lambda: advising.narrator is not None)
    killed = advising.narrator
    kill(killed)
    wait_until(lambda: "was killed by SIGKILL; it is started again" in advising.warned)
    wait_until(lambda: advising.narrator not in (None, killed))
    assert advising.end() == 130
