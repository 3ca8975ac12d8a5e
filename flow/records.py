"""Files of recorded figures: JSON with a line for each name, so that a change is a line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

__all__ = ["read_records", "record_row"]


def read_records(file: Path) -> dict[str, dict[str, Any]]:
    """Return the recorded rows, by name."""
    return json.loads(file.read_text()) if file.exists() else {}


def record_row(file: Path, name: str, row: dict[str, Any]) -> None:
    """Put a row in place of the one of its name; the file is whole at all times.

    Raises
    ------
    OSError
        If the file cannot be written; then it is as it was.
    """
    rows = sorted({**read_records(file), name: row}.items())
    lines = (f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in rows)
    part = file.with_suffix(".part")
    try:
        part.write_text("{\n" + ",\n".join(lines) + "\n}\n")
        part.replace(file)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
