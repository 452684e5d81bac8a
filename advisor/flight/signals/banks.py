"""Servo outputs from several banks, combined into one sample.

SERVO_OUTPUT_RAW carries sixteen outputs, and its ``port`` names the bank. A surface whose outputs lie in two
banks needs two messages for one sample.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import Columns, cut, joined
from advisor.process.arrays import FloatArray, IntArray

_OUTPUTS = 16
"""Number of outputs in one SERVO_OUTPUT_RAW (MAVLink's common.xml)."""


@dataclass(frozen=True, slots=True)
class Pulses:
    """Pulse widths of the servo outputs, with the messages that contained them."""

    columns: Columns
    """The n messages of the batch."""
    ports: IntArray
    """Shape (m + n,): bank of each message, where the first m are earlier messages."""
    raw: FloatArray
    """Shape (m + n, outputs of a bank): pulse widths, us."""

    def of(self, outputs: Sequence[int]) -> FloatArray:
        """Return the pulse widths of the given outputs, shape (n, number of outputs), us.

        Each message of the last bank gives a sample, with the newest pulses of the other banks. NaN marks a
        message of another bank. NaN also marks a sample if another bank sent nothing since the sample before.
        """
        size = self.raw.shape[1]
        banks = [(n - 1) // size for n in outputs]
        rows = np.arange(len(self.ports))
        of_last = self.ports == max(banks)
        before = np.concatenate(([-1], np.maximum.accumulate(np.where(of_last, rows, -1))[:-1]))
        pulses = np.full((len(rows), len(outputs)), np.nan)
        for k, (n, bank) in enumerate(zip(outputs, banks, strict=True)):
            newest = np.maximum.accumulate(np.where(self.ports == bank, rows, -1))
            complete = of_last & (newest > before)
            pulses[complete, k] = self.raw[newest[complete], (n - 1) % size]
        return pulses[len(rows) - len(self.columns.order) :]

    def source(self, outputs: Sequence[int]) -> str:
        """Return the source of the given outputs as ``MESSAGE.field+field``."""
        if self.columns.name == "ACTUATOR_OUTPUT_STATUS":
            return f"{self.columns.name}.actuator" + "+".join(f"[{n - 1}]" for n in outputs)
        banks = {(n - 1) // _OUTPUTS for n in outputs}
        names = [
            f"port{(n - 1) // _OUTPUTS}.servo{(n - 1) % _OUTPUTS + 1}_raw"
            if len(banks) > 1
            else f"servo{(n - 1) % _OUTPUTS + 1}_raw"
            for n in outputs
        ]
        return f"{self.columns.name}." + "+".join(names)


def merged(part: Sequence[Columns]) -> list[Columns]:
    """Return the columns with one sender's SERVO_OUTPUT_RAW merged, which some logs separate by bank."""
    senders: dict[int, list[Columns]] = {}
    for c in part:
        if c.name == "SERVO_OUTPUT_RAW":
            senders.setdefault(c.component, []).append(c)
    kept = [c for c in part if c.name != "SERVO_OUTPUT_RAW"]
    return kept + [_in_order(joined(banks)) if len(banks) > 1 else banks[0] for banks in senders.values()]


def _in_order(banks: Columns) -> Columns:
    return cut(banks, np.argsort(banks.order))


class Banks:
    """Memory of the last message of every bank."""

    def __init__(self) -> None:
        self._ports: IntArray = np.empty(0, dtype=np.int64)
        self._raw: FloatArray = np.empty((0, _OUTPUTS))

    def together(self, columns: Columns) -> Pulses:
        """Return the pulses of servo output messages, completed by earlier messages."""
        if columns.name == "ACTUATOR_OUTPUT_STATUS":
            every = np.asarray(columns.fields["actuator"], dtype=np.float64)
            return Pulses(columns, np.zeros(len(every), dtype=np.int64), every)
        silent = np.zeros(len(columns.order))
        fields = [columns.fields.get(f"servo{k}_raw", silent) for k in range(1, _OUTPUTS + 1)]
        ports = np.concatenate((self._ports, np.asarray(columns.fields["port"], dtype=np.int64)))
        raw = np.concatenate((self._raw, np.stack(fields, axis=1).astype(np.float64)))
        last = [int(np.flatnonzero(ports == port)[-1]) for port in np.unique(ports)]
        kept = np.sort(last)
        self._ports, self._raw = ports[kept], raw[kept]
        return Pulses(columns, ports, raw)
