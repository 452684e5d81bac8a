"""``make flight``: ArduPlane flies the written script, and ``advisor expect`` decides."""

from pathlib import Path

import pytest

from benchmarks.scripted import expected


def test_without_arduplane_the_job_says_so_and_ends_with_0(monkeypatch, tmp_path: Path, capsys) -> None:
    monkeypatch.setattr(expected, "SITL", tmp_path)
    assert expected.main([]) == 0
    assert capsys.readouterr().out == f"No flight: {tmp_path} holds no ArduPlane.\n"


@pytest.mark.parametrize(
    ("late_ms", "speedups", "said"), [((0,), ["4"], ""), ((900, 30), ["4", "2"], "too late at 4 times")]
)
def test_a_flight_whose_script_was_called_late_is_flown_again_at_half_the_pace(
    monkeypatch, tmp_path: Path, capsys, late_ms, speedups, said
) -> None:
    late, flown = iter(late_ms), []

    def fly(folder: Path, speedup: str) -> int:
        flown.append(speedup)
        (folder / "flight.tlog").write_bytes(b"ADVISOR LATE: calls up to %d ms apart in 2\x00" % next(late))
        return 0

    (tmp_path / "arduplane.xz").touch()
    monkeypatch.setattr(expected, "SITL", tmp_path)
    monkeypatch.setattr(expected, "_fly", fly)
    monkeypatch.setattr(
        expected, "_compare", lambda flight, _: 1 if speedups[-1] in flight.parent.name else 9
    )
    assert expected.main(["--keep", str(tmp_path / "kept")]) == 1
    assert flown == speedups
    assert said in capsys.readouterr().out
