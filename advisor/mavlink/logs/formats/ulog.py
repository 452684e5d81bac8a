"""PX4's log (``.ulg``)."""

from advisor.mavlink.logs.formats import LogFormat
from advisor.mavlink.px4.ulog import MAGIC, read_ulog
from advisor.words.problems import Problem


def _begins_at(beginning: bytes) -> int | None:
    at = beginning.find(MAGIC)
    return at if at >= 0 else None


def _encrypted(name: str, beginning: bytes) -> Problem | None:
    if not beginning.startswith(b"ULogEnc"):
        return None
    return Problem(
        "encrypted",
        f"{name} is an encrypted log of PX4.",
        "Decrypt it with PX4's Tools/decrypt_ulog.py and the private key, and give the .ulg.",
    )


FORMAT = LogFormat(
    holds="ULog",
    given="a PX4 .ulg",
    ending=".ulg",
    begins_at=_begins_at,
    read=lambda path, wanted, starts_at, scanner: read_ulog(path, wanted, starts_at),
    refusal=_encrypted,
)
