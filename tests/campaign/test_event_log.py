"""The event log keeps its newest sentences."""

import pytest

from advisor.campaign import journal


def test_an_event_log_forgets_the_oldest_sentences(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journal, "KEPT", 3)
    log = journal.Journal()
    for k in range(5):
        log.write(str(k))
    assert [line.split()[-1] for line in log.lines] == ["2", "3", "4"]


def test_an_event_log_keeps_its_lines_until_something_is_added() -> None:
    log = journal.Journal()
    log.write("heard")
    lines = log.lines
    assert log.lines is lines
    log.write("heard again")
    assert log.lines is not lines
