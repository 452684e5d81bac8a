"""An event log keeps its newest sentences."""

from advisor.campaign.journal import EventLog


def test_an_event_log_forgets_the_oldest_sentences():
    log = EventLog(3)
    log.add(str(k) for k in range(5))
    assert log.lines == ("2", "3", "4")


def test_an_event_log_keeps_its_lines_until_something_is_added():
    log = EventLog(3)
    log.add(["heard"])
    lines = log.lines
    log.add([])
    assert log.lines is lines
