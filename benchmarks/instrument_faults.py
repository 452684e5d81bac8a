"""Faulty instruments in records that are sound: is the channel named, and is a wrong number accepted?

    python -m benchmarks.instrument_faults FLIGHTS [--only NAME ...] [--json FILE]

FLIGHTS is a folder of logs, each next to its aircraft file. Every fault is put into every record in turn. A
row is *named* when the analysis says that this channel contradicts, or corrects it. A row is *wrong* when a
model is accepted whose 95 % interval lies apart from that of the sound record.
"""

import argparse
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.campaign.campaign import Campaign
from advisor.flight.signals.channels import stamps
from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.logs import open_log
from advisor.process.arrays import FloatArray
from advisor.report.document import analysis_document
from advisor.words.problems import UnusableInputError
from advisor.words.quantities import NORMAL_95

Document = dict[str, Any]
Change = Callable[[FloatArray, FloatArray], FloatArray]
"""Values of a field after the fault, from the stamps in s and the true values."""
LATE_S = 0.1
COMPARED = ("Z_alpha", "M_alpha", "M_q", "M_delta_e")
IMU = ("RAW_IMU", "SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3", "HIGHRES_IMU")
FIELDS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "alpha": {"AOA_SSA": ("AOA",), "NAMED_VALUE_FLOAT": ("value",)},
    "q": {"ATTITUDE": ("pitchspeed",)},
    "theta": {"ATTITUDE": ("pitch",)},
    "a_z": dict.fromkeys(IMU, ("zacc",)),
    "airspeed": {"VFR_HUD": ("airspeed",)},
}
"""Channel to the fields that carry it, by message."""


def times(factor: float) -> Change:
    """Return a fault that multiplies."""
    return lambda t, y: factor * y


def late(t: FloatArray, y: FloatArray) -> FloatArray:
    """Return the values of ``LATE_S`` before."""
    rising = np.concatenate([[True], np.diff(t) > 0.0])
    return np.interp(t - LATE_S, t[rising], y[rising])


FAULTS: Mapping[str, tuple[str, Change]] = {
    "alpha reversed": ("alpha", times(-1.0)),
    "alpha in rad": ("alpha", times(np.pi / 180.0)),
    "alpha 100 ms late": ("alpha", late),
    "q reversed": ("q", times(-1.0)),
    "q in deg/s": ("q", times(180.0 / np.pi)),
    "q 100 ms late": ("q", late),
    "theta reversed": ("theta", times(-1.0)),
    "theta 100 ms late": ("theta", late),
    "a_z reversed": ("a_z", times(-1.0)),
    "a_z in g": ("a_z", times(1.0 / 9.80665)),
    "a_z 100 ms late": ("a_z", late),
    "a_z stands still": ("a_z", times(0.0)),
    "air speed in knots": ("airspeed", times(1.9438)),
}
"""Name of each fault to the channel and the change of its values."""


@dataclass(frozen=True)
class Row:
    """One fault in one record."""

    record: str
    fault: str
    named: bool
    stops: bool
    apart: float
    """Largest distance of a compared derivative from the sound record's, in half-widths of both 95 %
    intervals. NaN without an accepted model."""
    values: Mapping[str, float]

    @property
    def wrong(self) -> bool:
        """Whether a wrong model is accepted."""
        return self.apart > 1.0

    def text(self) -> str:
        """Return one line of the table."""
        said = "named" if self.named else "NOT NAMED"
        accepted = "refused" if np.isnan(self.apart) else f"apart {self.apart:.1f}"
        return (
            f"{self.record:<24}{self.fault:<22}{said:<11}{accepted:<14}"
            f"{'WRONG ' if self.wrong else ''}{'STOP' if self.stops else ''}"
        )


def analyzed(log: Path, aircraft: Aircraft, fault: tuple[str, Change] | None) -> tuple[Document | None, bool]:
    """Return the document of ``advisor analyze`` for a log with a fault, and whether the channel is there."""
    campaign, present = Campaign(aircraft), fault is None
    try:
        for batch in open_log(log):
            changed = [_with(fault, columns) for columns in batch]
            present |= any(new is not old for new, old in zip(changed, batch, strict=True))
            campaign.feed(changed)
    except UnusableInputError:
        return None, present
    campaign.finish()
    state = campaign.state
    left_out = {one.flight: one.problems for one in state.flights if one.problems}
    return analysis_document(state, [str(log)], aircraft, left_out, []), present


def _with(fault: tuple[str, Change] | None, columns: Columns) -> Columns:
    if fault is None or columns.name not in FIELDS[fault[0]] or len(columns) < 2:
        return columns
    channel, change = fault
    t = stamps(columns, columns.arrival_s)
    if not np.ptp(t) > 0.0:
        # A sender that fills in no stamps: the messages are told apart by their arrival.
        t = columns.arrival_s
    fields = dict(columns.fields)
    for name in FIELDS[channel][columns.name]:
        fields[name] = change(t, np.asarray(fields[name], dtype=np.float64))
    return replace(columns, fields=fields)


def row_of(record: str, fault: str, found: Document, sound: Document) -> Row:
    """Return the comparison of a faulty record's document with the sound one's."""
    channel = FAULTS[fault][0]
    told = [i["channel"] for i in found.get("instruments") or [] if i["contradicts"] or i.get("used")]
    codes = [r["code"] for m in found["maneuvers"] for r in m["reasons"]] + [
        p["code"] for p in found["problems"]
    ]
    named = channel in told or any(code.startswith(f"{channel}_") for code in codes)
    model, true = found.get("model"), sound.get("model")
    apart, values = float("nan"), {}
    if model and true:
        values = {name: model[name]["value"] for name in COMPARED}
        widths = {n: NORMAL_95 * float(np.hypot(model[n]["std"], true[n]["std"])) for n in COMPARED}
        apart = max(abs(model[n]["value"] - true[n]["value"]) / widths[n] for n in COMPARED)
    return Row(record, fault, named, found["flight_test"]["decision"] == "stop", apart, values)


def rows(folder: Path, only: Sequence[str]) -> Iterator[Row]:
    """Yield every fault of every record that has an accepted model when sound."""
    for file in sorted(folder.glob("*.yaml")):
        log = next((p for p in folder.glob(f"{file.stem}.*") if p.suffix != ".yaml"), None)
        if log is None or (only and file.stem not in only) or file.stem.startswith("lateral"):
            continue
        aircraft = load_aircraft(file)
        sound, _ = analyzed(log, aircraft, None)
        if sound is None or not sound.get("model"):
            continue
        for fault, change in FAULTS.items():
            found, present = analyzed(log, aircraft, change)
            if present and found is not None:
                yield row_of(file.stem, fault, found, sound)


def main() -> None:
    """Print the table and its sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("flights", type=Path)
    parser.add_argument("--only", nargs="*", default=())
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    found = []
    for row in rows(given.flights, given.only):
        print(row.text(), flush=True)
        found.append(row)
    named, wrong = sum(r.named for r in found), sum(r.wrong for r in found)
    print(f"{len(found)} faulty records: {named} named (goal 95 %), {wrong} accepted and wrong (goal 0)")
    print(f"stops: {sum(r.stops for r in found)}, of these wrong: {sum(r.stops and r.wrong for r in found)}")
    if given.json:
        given.json.write_text(json.dumps([vars(r) for r in found], indent=1))


if __name__ == "__main__":
    main()
