"""A simulator in its own process: what comes back of it, and what of its faults."""

import multiprocessing
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from advisor.simulators import isolated
from advisor.simulators.isolated import Isolated
from advisor.simulators.protocol import Condition, Inputs
from advisor.words.problems import ConfigurationError, UnusableInputError
from tests.mavlink.link.builders import wait_until
from tests.simulators.makeshift import Constant

HERE = "tests.simulators.makeshift"
CONDITION = Condition(30.0, 500.0)
INPUTS = Inputs(np.array([0.0, 0.01, 0.02, 0.03, 0.04]), np.zeros(5))


def faulty(fault: str, limit_s: float = 30.0) -> Isolated:
    return Isolated(f"{HERE}:Faulty", fault, description="makeshift", speed_limit_s=limit_s)


def complaint(simulator: Isolated) -> UnusableInputError:
    with pytest.raises(UnusableInputError) as caught:
        simulator.replay(CONDITION, INPUTS)
    simulator.close()
    return caught.value


def test_a_process_that_cannot_start_says_why(monkeypatch) -> None:
    """A script without ``if __name__ == "__main__"`` starts itself again in the child."""

    class Unstarted:
        Pipe, Process = staticmethod(multiprocessing.Pipe), multiprocessing.Process

    def refuse(_: object) -> None:
        raise RuntimeError("before the current process has finished its bootstrapping phase")

    monkeypatch.setattr(isolated, "spawning", Unstarted)
    monkeypatch.setattr(multiprocessing.Process, "start", refuse)
    with pytest.raises(RuntimeError, match="bootstrapping"):
        Isolated(f"{HERE}:Level", description="level")


def test_a_replay_and_a_linearisation_come_back_as_numbers() -> None:
    simulator = Isolated(f"{HERE}:Level", description="level")
    flown = simulator.replay(CONDITION, INPUTS)
    assert simulator.takes_increments
    assert flown.airspeed_m_s.tolist() == [30.0] * 5
    assert flown.t.tolist() == INPUTS.t.tolist()
    assert simulator.linearise(CONDITION) == {"M_alpha": -30.0}
    simulator.close()


def test_increments_reach_the_other_process() -> None:
    simulator = Isolated(f"{HERE}:Level", description="level")
    assert simulator.replay(CONDITION, INPUTS, Constant(0.25, 0.0)).alpha.tolist() == [0.25] * 5
    simulator.close()


def test_a_hang_is_ended_at_the_time_limit_and_the_process_with_it() -> None:
    simulator = faulty("hang", limit_s=0.5)
    process = simulator._process.pid
    assert str(complaint(simulator)).startswith("makeshift does not finish a replay within 0.5 s.")
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_what_a_simulator_has_started_ends_with_it(tmp_path: Path) -> None:
    note = tmp_path / "pid"
    simulator = faulty(f"helper:{note}", limit_s=2.0)
    complaint(simulator)
    helper = Path(f"/proc/{note.read_text()}/stat")
    wait_until(lambda: not helper.exists() or helper.read_text().rpartition(")")[2].split()[0] == "Z")


@pytest.mark.skipif(os.name != "posix", reason="the system knows no limit of a process's memory")
def test_a_simulator_that_asks_for_too_much_memory_fails_alone() -> None:
    assert "makeshift fails in a replay: " in str(told := complaint(faulty("devour")))
    assert "MemoryError" in str(told)


def test_a_crash_is_told_with_its_signal() -> None:
    assert "The process of makeshift ended during a replay by signal SIGABRT." in str(
        complaint(faulty("crash"))
    )


def test_an_exit_is_told_with_its_code() -> None:
    assert "ended during a replay with exit code 7." in str(complaint(faulty("leave")))


def test_an_exception_of_a_foreign_class_comes_back_as_text() -> None:
    assert "makeshift fails in a replay: PrivateError: the wing is off." in str(complaint(faulty("raise")))


def test_a_refusal_comes_back_as_the_simulator_worded_it() -> None:
    assert str(complaint(faulty("refuse"))) == "No trim. Fly faster."


def test_a_replay_that_is_not_finite_is_refused_with_its_channel_and_sample() -> None:
    assert "its replay's q is not finite from sample 3" in str(complaint(faulty("nan")))


def test_a_simulator_flies_again_after_a_crash() -> None:
    simulator = faulty("crash")
    for _ in range(2):
        with pytest.raises(UnusableInputError, match="SIGABRT"):
            simulator.replay(CONDITION, INPUTS)
    assert simulator.linearise(CONDITION) == {"M_alpha": -30.0}
    simulator.close()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        ("no_such_module:factory", "No module named 'no_such_module'"),
        (f"{HERE}:no_such_factory", "no_such_factory"),
        (f"{HERE}:fails", "RuntimeError: no licence"),
    ],
)
def test_what_cannot_be_built_is_a_wrong_configuration(make: str, words: str) -> None:
    with pytest.raises(ConfigurationError, match=words):
        Isolated(make, description="makeshift")


def test_a_start_has_its_own_time_limit() -> None:
    with pytest.raises(ConfigurationError, match="does not finish its start within"):
        Isolated(f"{HERE}:never_ready", description="makeshift", start_limit_s=0.5)


def test_nothing_of_the_simulator_is_imported_here_and_nothing_it_prints_is_seen(tmp_path: Path) -> None:
    (tmp_path / "my_simulator.py").write_text(
        f"from {HERE} import Faulty\nprint('loaded')\n\ndef make():\n    return Faulty('print')\n"
    )
    (tmp_path / "fly.py").write_text(
        "import sys\nimport numpy as np\n"
        "from advisor.simulators.isolated import Isolated\n"
        "from advisor.simulators.protocol import Condition, Inputs\n"
        "if __name__ == '__main__':\n"
        "    simulator = Isolated('my_simulator:make', description='mine')\n"
        "    simulator.replay(Condition(30.0), Inputs(np.arange(3.0), np.zeros(3)))\n"
        "    simulator.close()\n"
        "    print('imported' if 'my_simulator' in sys.modules else 'apart')\n"
    )
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "fly.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(root)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "apart\n"
    assert done.stderr == ""
