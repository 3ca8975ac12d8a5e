"""Cloud files of every supported format, read into a :class:`Cloud`."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from pathlib import Path

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud

from .assemble import Columns, assemble_cloud
from .read_npz import read_npz
from .read_pcd import read_pcd
from .read_ply import read_ply
from .read_text import read_text

__all__ = ["FORMATS", "read_cloud"]

FORMATS: dict[str, Callable[[Path], Columns]] = {
    ".ply": read_ply,
    ".pcd": read_pcd,
    ".xyz": read_text,
    ".xyzn": read_text,
    ".xyzrgb": read_text,
    ".txt": read_text,
    ".asc": read_text,
    ".csv": read_text,
    ".npz": read_npz,
}
"""Reader of each format, by the file name's suffix in lower case."""


def read_cloud(path: str | os.PathLike[str]) -> Cloud:
    """Read a cloud from a file; the name's suffix tells the format.

    A mesh's vertices are points. Positions are relative to the cloud's own centre. Missing normals
    are estimated, and points without a colour get one. Points without a finite position are dropped
    and counted (see ``assemble_cloud``).

    Parameters
    ----------
    path
        PLY, PCD, NPZ, or text: XYZ, XYZN, XYZRGB, TXT, ASC or CSV.

    Raises
    ------
    InputError
        If the file is missing, unreadable, empty, truncated or otherwise damaged, of an unknown
        format, or has no x, y and z or no point with a finite position.
    """
    place = Path(path)
    try:
        if place.is_dir():
            raise InputError("is a folder; give the name of a file")
        read = FORMATS.get(place.suffix.lower())
        size = place.stat().st_size
        if read is None:
            kinds = " ".join(FORMATS)
            raise InputError(
                f"unknown format {place.suffix!r}; the name must end in one of {kinds}"
            )
        if not size:
            raise InputError("the file is empty")
        return assemble_cloud(_read(read, place), place.stem)
    except OSError as error:
        raise InputError(f"{place}: cannot be read: {error.strerror or error}") from None
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def _read(read: Callable[[Path], Columns], place: Path) -> Columns:
    """Return a reader's columns; its failures become ``InputError``."""
    kind = place.suffix[1:].upper()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a warning of a parser is about the file
            return read(place)
    except (OSError, InputError):
        raise
    except MemoryError:
        raise InputError("does not fit the memory, or is damaged and claims to be huge") from None
    except UnicodeDecodeError:
        raise InputError(f"cannot be read as {kind}: it is not text") from None
    except Exception as error:
        # Parsers raise errors of many types for damaged files; a traceback would not help. Their
        # text may have several lines.
        text = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(f"cannot be read as {kind}; is it damaged? ({text})") from None
