"""Checks of output files before the work begins, and writing of text and JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from splatline.contract.errors import InputError

__all__ = [
    "check_files",
    "check_folder",
    "lines_of_json",
    "require_suffix",
    "write_json",
    "write_text",
]


def check_files(outputs: Iterable[Path | None], *, inputs: Iterable[Path | None] = ()) -> None:
    """Raise if a file could not be written, before work is done that would be lost.

    Parameters
    ----------
    outputs
        Files to be written; None is a file that was not asked for.
    inputs
        Files that are read and must not be overwritten.

    Raises
    ------
    InputError
        If a folder is missing or not writable, a file is a folder, two outputs are one file, or an
        output is an input.
    """
    read = {path.resolve() for path in inputs if path is not None}
    written: set[Path] = set()
    for path in outputs:
        if path is None:
            continue
        if path.is_dir():
            raise InputError(f"{path}: is a folder; give the name of a file")
        if not path.parent.is_dir():
            raise InputError(f"{path}: there is no folder {path.parent}; create it first")
        if not os.access(path.parent, os.W_OK):
            raise InputError(f"{path}: the folder {path.parent} is not writable")
        resolved = path.resolve()
        if resolved in read:
            raise InputError(f"{path}: would be written over the input; choose another name")
        if resolved in written:
            raise InputError(f"{path}: two outputs have this name; choose another for one of them")
        written.add(resolved)


def check_folder(folder: Path | None) -> None:
    """Raise ``InputError`` unless a folder is writable, or can be created."""
    if folder is None:
        return
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file; give the name of a folder")
    nearest = next(parent for parent in (folder, *folder.resolve().parents) if parent.exists())
    if not nearest.is_dir():
        raise InputError(f"{folder}: {nearest} is a file, not a folder")
    if not os.access(nearest, os.W_OK):
        raise InputError(f"{folder}: the folder {nearest} is not writable")


def require_suffix(path: Path | None, suffix: str) -> None:
    """Raise ``InputError`` if a file's suffix is not that of the format that is written."""
    if path is not None and path.suffix.lower() != suffix:
        raise InputError(f"{path}: the name must end in {suffix}, the format that is written")


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically."""
    from splatline.contract.atomic_write import atomic_write

    atomic_write(path, text.encode())


def write_json(path: Path, data: dict[str, Any]) -> None:
    """Write a JSON file atomically; infinities and NaN are refused."""
    write_text(path, json.dumps(data, indent=2, allow_nan=False) + "\n")


def lines_of_json(results: Mapping[str, Any]) -> str:
    """Return JSON in which each object of a list has a line of its own, for line-by-line diffs."""
    parts = []
    for key, value in results.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            rows = ",\n".join(f"    {json.dumps(row, allow_nan=False)}" for row in value)
            parts.append(f'  "{key}": [\n{rows}\n  ]')
        else:
            parts.append(f'  "{key}": {json.dumps(value, allow_nan=False)}')
    return "{\n" + ",\n".join(parts) + "\n}\n"
