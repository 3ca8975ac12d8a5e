"""Files of recorded figures: JSON with a line for each name, so that a change is a line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from splatline.contract.atomic_write import atomic_write

__all__ = ["read_records", "record_row"]


def read_records(file: Path) -> dict[str, dict[str, Any]]:
    """Return the recorded rows, by name."""
    return json.loads(file.read_text()) if file.exists() else {}


def record_row(file: Path, name: str, row: dict[str, Any]) -> None:
    """Put a row in place of the one of its name.

    Raises
    ------
    InputError
        If the file cannot be written; then it is as it was.
    """
    rows = sorted({**read_records(file), name: row}.items())
    lines = (f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in rows)
    atomic_write(file, ("{\n" + ",\n".join(lines) + "\n}\n").encode())
