"""Documents against the schema files of the documentation."""

import json
from functools import cache
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator

SCHEMAS = Path(__file__).parents[1] / "docs" / "reference" / "schemas"


def breaches(name: str, document: Any) -> list[str]:
    """Sentences on what the schema does not allow; keys that the schema does not know are breaches, too."""
    return [f"{error.json_path}: {error.message[:200]}" for error in _validator(name).iter_errors(document)]


def schema(name: str) -> dict[str, Any]:
    """The schema file of a document."""
    content: dict[str, Any] = json.loads((SCHEMAS / f"{name}.json").read_text(encoding="utf-8"))
    return content


@cache
def _validator(name: str) -> Draft202012Validator:
    return Draft202012Validator(_closed(schema(name)))


def _closed(part: Any) -> Any:
    """The schema without room for further keys, which users have and the project's own documents have not."""
    if isinstance(part, list):
        return [_closed(one) for one in part]
    if not isinstance(part, dict):
        return part
    inside = {key: _closed(value) for key, value in part.items()}
    if "properties" in inside and isinstance(inside["properties"], dict):
        inside.setdefault("additionalProperties", False)
    return inside
