"""Linear algebra of tests runs in one thread, as that of the command does."""

import sys


def test_one_thread_is_set_before_numpy_reads_the_number_of_threads():
    loaded = list(sys.modules)
    assert loaded.index("advisor.process.tasks.pinned") < loaded.index("numpy")
