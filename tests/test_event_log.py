"""An event log keeps its newest sentences, and whoever follows it misses none."""

from advisor.event_log import EventLog
from advisor.tui.chronicle import Chronicle


def test_an_event_log_forgets_the_oldest_sentences_and_counts_them():
    log = EventLog(3)
    log.add(str(k) for k in range(5))
    assert log.lines == ("2", "3", "4")
    assert log.before == 2


def test_an_event_log_keeps_its_lines_until_something_is_added():
    log = EventLog(3)
    log.add(["heard"])
    lines = log.lines
    log.add([])
    assert log.lines is lines


def test_a_chronicle_follows_an_event_log_that_has_forgotten_sentences():
    log, chronicle = EventLog(3), Chronicle()
    for k in range(8):
        log.add([f"{k}a", f"{k}b"])
        chronicle.follow(log.lines, log.before)
    assert chronicle.lines == tuple(f"{k}{letter}" for k in range(8) for letter in "ab")
