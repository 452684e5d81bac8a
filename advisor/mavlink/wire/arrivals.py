"""Classification of packets. Repeats by a second path are dropped, and losses and late packets are counted.

Two radios, a router's loop or a duplicated output deliver packets twice, up to `REPEAT_US` apart. A repeat
has source, sequence number, message and checksum of an earlier packet. A single repeat proves no second path,
because sequence numbers recur and heartbeats are equal. A number of `_RUN` successive repeats proves a second
path.

A late path also delivers packets that the first path lost. Such a packet arrives among repeats and continues
their sequence numbers. If the path is late by more than `LATE_US`, the packet is dropped. When the first path
is silent, the late path's packets count as new.
"""

import numpy as np
from numpy.typing import NDArray

from advisor.process.compiled import kernel

Ints = NDArray[np.int64]

REPEAT_US = 18_000_000
"""Longest time between a packet and its repeat, us. Radios and routers delay packets by up to 15 s."""
LATE_US = 2_000_000
"""Delay of a path, us, above which only its repeats are recognised. Channels accept samples up to this
age."""
_PATH_US = 2_000_000
"""Time after a path's last packet for which the path is remembered, us. A heartbeat comes once a second."""
_RUN = 8
"""Number of successive repeats that prove a second path. One heartbeat in 256 after a loss repeats by
chance."""
_STEADY_US = 1_000_000
"""Largest change of a path's delay between two packets, us. A larger change belongs to another path."""
_STEP = 16
"""Largest step of sequence numbers between a path's packets, including short losses."""
_MOST_NEW = 64
"""Largest number of successive packets that only a late path delivers. With more new packets the late path
becomes the first path."""
_BACK = 192
"""Least step of sequence numbers (modulo 256) that shows a packet out of order."""

# State of each sender.
HEARD, NEWEST, NEWEST_US, LOST, LATE, REPEATED, REPEATED_LATE_US = range(7)
"""Packets heard; the newest one's sequence number and arrival, us; packets lost, late, repeated; the sum of
the repeats' lateness, us."""
_ECHO, _ECHO_US, _ECHO_LATE_US, _ECHO_RUN, _ECHO_NEW = range(7, 12)
"""The second path's newest sequence number, its arrival and lateness, us; its repeats in a row; and packets
since the last repeat."""
SENDER_COLUMNS = 12

# State of each packet: its mark, arrival, and the earlier packet with its sequence number.
_MARK, _AT_US, _BEFORE = range(3)
PACKET_COLUMNS = 3
PACKETS = 1 << 15
"""Number of remembered packets: those of ``REPEAT_US`` at 1800 per second."""
COUNT = 256
"""Entry of ``newest`` with the number of packets so far. One entry for each sequence number is before it."""


@kernel()
def _heard_ago(packets: Ints, newest: Ints, sequence: int, mark: int, now_us: int) -> int:
    """Return the age of a packet's earlier copy, us; -1 without a copy within ``REPEAT_US``."""
    number = newest[sequence]
    while number > newest[COUNT] - PACKETS and number > 0:
        row = number % PACKETS
        ago_us = now_us - packets[row, _AT_US]
        if abs(ago_us) > REPEAT_US:  # long ago, or before the station's clock was set back
            return -1
        if packets[row, _MARK] == mark and ago_us >= 0:
            return int(ago_us)
        number = packets[row, _BEFORE]
    return -1


@kernel()
def _has_path(senders: Ints, source: int, now_us: int) -> bool:
    """Return whether copies of packets arrived recently over a second path."""
    return bool(senders[source, _ECHO_RUN] > 0 and 0 <= now_us - senders[source, _ECHO_US] <= _PATH_US)


@kernel()
def _is_heard_again(
    senders: Ints, packets: Ints, newest: Ints, source: int, sequence: int, mark: int, now_us: int
) -> bool:
    """Return whether a packet repeats an earlier one. If so, the state of the second path moves to this
    packet.

    Without a second path, a message that a vehicle sends again with its next sequence number is new.
    """
    has_path = _has_path(senders, source, now_us)
    if not has_path and sequence == (senders[source, NEWEST] + 1) & 0xFF:
        return False
    ago_us = _heard_ago(packets, newest, sequence, mark, now_us)
    if ago_us < 0:
        return False
    senders[source, REPEATED] += 1
    senders[source, REPEATED_LATE_US] += ago_us
    is_established = has_path and senders[source, _ECHO_RUN] >= _RUN
    if not is_established or abs(ago_us - senders[source, _ECHO_LATE_US]) <= _STEADY_US:
        senders[source, _ECHO], senders[source, _ECHO_US] = sequence, now_us
        senders[source, _ECHO_LATE_US], senders[source, _ECHO_NEW] = ago_us, 0
        senders[source, _ECHO_RUN] = senders[source, _ECHO_RUN] + 1 if has_path else 1
    return True


@kernel()
def _is_overtaken(senders: Ints, source: int, sequence: int, now_us: int) -> bool:
    """Return whether a new packet came by the late path, after later packets by the first path."""
    if senders[source, _ECHO_RUN] < _RUN or not _has_path(senders, source, now_us):
        return False
    ahead = (sequence - senders[source, NEWEST] - 1) & 0xFF
    beside = (sequence - senders[source, _ECHO] - 1) & 0xFF
    if beside > min(ahead, _STEP) or (0 < beside < ahead <= _STEP):  # the latter may have come either way
        return False
    senders[source, _ECHO_NEW] += 1
    if senders[source, _ECHO_NEW] > _MOST_NEW:
        return False
    senders[source, _ECHO], senders[source, _ECHO_US] = sequence, now_us
    late_us = senders[source, _ECHO_LATE_US]
    return bool(beside < ahead and late_us > LATE_US and now_us - senders[source, NEWEST_US] < late_us)


@kernel()
def weigh(
    senders: Ints, packets: Ints, newest: Ints, source: int, sequence: int, mark: int, now_us: int
) -> bool:
    """Count one packet, and return whether the packet is new.

    Parameters
    ----------
    senders : shape (65536, SENDER_COLUMNS)
        State of each sender, which is changed.
    packets, newest : shape (PACKETS, PACKET_COLUMNS), (COUNT + 1,)
        Newest packets, and the index of the newest packet of each sequence number; changed.
    source, sequence, mark, now_us
        The packet's sender, sequence number, distinguishing mark, and time of arrival, us.
    """
    first = senders[source, HEARD] == 0
    senders[source, HEARD] += 1
    ahead = 256 - ((senders[source, NEWEST] - sequence) & 0xFF)  # 1: the next one, 256: the same number
    plain = first or (ahead == 1 and senders[source, _ECHO_RUN] == 0)
    again = not plain and _is_heard_again(senders, packets, newest, source, sequence, mark, now_us)
    if again and senders[source, _ECHO_RUN] >= _RUN:
        return False
    number = newest[COUNT] = newest[COUNT] + 1
    row = number % PACKETS
    packets[row, _MARK], packets[row, _AT_US], packets[row, _BEFORE] = mark, now_us, newest[sequence]
    newest[sequence] = number
    if not plain and _is_overtaken(senders, source, sequence, now_us):
        senders[source, LATE] += 1
        return False
    if first or ahead < _BACK:
        senders[source, LOST] += 0 if first else ahead - 1
        senders[source, NEWEST], senders[source, NEWEST_US] = sequence, now_us
    elif ahead < 256 and not again:
        senders[source, LATE] += 1
        senders[source, LOST] = max(0, senders[source, LOST] - 1)
    return True
