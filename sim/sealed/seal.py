"""Seals. The key's salted hash is published first, and the hash of the answers before the key is opened."""

import hashlib
import json
import secrets
from pathlib import Path
from typing import Any

SEAL = "SEAL"
"""Name of the file in the cases' folder with the hash of salt and key."""

COMMITMENT = "COMMITMENT"
"""Name of the file in the cases' folder with the hash of the answers."""


class SealError(ValueError):
    """A seal is missing or broken. The error message names the seal."""


def seal(key: dict[str, Any], key_file: Path, folder: Path) -> str:
    """Write the key outside the folder and its salted hash inside, and return the hash.

    The salt prevents that guessed keys are tested against the hash.
    """
    text = json.dumps({"salt": secrets.token_hex(32), "key": key}, sort_keys=True)
    digest = hashlib.sha256(text.encode()).hexdigest()
    key_file.write_text(text, encoding="utf-8")
    key_file.chmod(0o600)
    (folder / SEAL).write_text(digest + "\n", encoding="utf-8")
    return digest


def commit(folder: Path, answers: Path) -> str:
    """Store the hash of the answers, and return the hash.

    Raises
    ------
    SealError
        Other answers were committed earlier.
    """
    digest = hashlib.sha256(answers.read_bytes()).hexdigest()
    place = folder / COMMITMENT
    if place.exists() and place.read_text(encoding="utf-8").strip() != digest:
        raise SealError(f"{place}: other answers were committed before; cases can be answered only once")
    place.write_text(digest + "\n", encoding="utf-8")
    return digest


def unseal(folder: Path, answers: Path, key_file: Path) -> dict[str, Any]:
    """Return the key, after a check of the committed answers and of the sealed key.

    Raises
    ------
    SealError
        There is no commitment, or the answers or the key differ from the sealed ones.
    """
    place = folder / COMMITMENT
    if not place.exists():
        program = f"python -m {__package__.split('.')[0]}"
        raise SealError(f"answers are not committed: run {program} commit {folder} {answers} first")
    if place.read_text(encoding="utf-8").strip() != hashlib.sha256(answers.read_bytes()).hexdigest():
        raise SealError(f"{answers}: not the answers that were committed")
    text = key_file.read_text(encoding="utf-8")
    if hashlib.sha256(text.encode()).hexdigest() != (folder / SEAL).read_text(encoding="utf-8").strip():
        raise SealError(f"{key_file}: not the key that was sealed")
    key: dict[str, Any] = json.loads(text)["key"]
    return key
