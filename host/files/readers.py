"""Cloud files of every supported format, read into a :class:`Cloud`."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import numpy as np

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud

from .assemble import assemble_cloud
from .colouring import check_map
from .columns import Columns
from .read_e57 import read_e57
from .read_las import read_las
from .read_mesh import read_mesh
from .read_npz import read_npy, read_npz
from .read_pcd import read_pcd
from .read_ply import read_ply
from .read_ptx import read_ptx
from .read_text import read_text
from .source import Progress, Source, cloud_name, format_suffix, open_source, usual_up
from .wanted import USUAL, ColourBy, Wanted

__all__ = [
    "FORMATS",
    "check_format",
    "open_cloud_file",
    "parser_errors",
    "read_cloud",
    "read_columns",
]

FORMATS: dict[str, Callable[[Source], Columns]] = {
    ".ply": read_ply,
    ".pcd": read_pcd,
    ".xyz": read_text,
    ".xyzn": read_text,
    ".xyzrgb": read_text,
    ".txt": read_text,
    ".asc": read_text,
    ".csv": read_text,
    ".pts": read_text,
    ".ptx": read_ptx,
    ".las": read_las,
    ".laz": read_las,
    ".e57": read_e57,
    ".obj": read_mesh,
    ".stl": read_mesh,
    ".off": read_mesh,
    ".glb": read_mesh,
    ".npz": read_npz,
    ".npy": read_npy,
}
"""Reader of each format, by the file name's suffix in lower case. Each may be followed by .gz."""


MESHES = (".ply", ".obj", ".stl", ".off", ".glb")
"""Formats whose faces can be sampled."""


def check_format(path: Path, format: str | None = None) -> str:
    """Return the suffix that tells a file's format: the one that is given, or its name's.

    Raises
    ------
    InputError
        If no such format is read.
    """
    kinds = " ".join(FORMATS)
    if format is not None:
        suffix = "." + format.lower().removeprefix(".")
        if suffix not in FORMATS:
            raise InputError(f"unknown format {format!r}; it must be one of {kinds}")
        return suffix
    if str(path) == "-":
        raise InputError(f"the standard input has no name; give its --format, one of {kinds}")
    suffix = format_suffix(path)
    if suffix not in FORMATS:
        raise InputError(
            f"unknown format {suffix!r}; the name must end in one of {kinds}, or in one of these"
            " and .gz, or the --format be given; convert other formats first, with CloudCompare for"
            " example"
        )
    return suffix


def read_cloud(
    path: str | os.PathLike[str],
    *,
    colour: str | ColourBy | None = None,
    format: str | None = None,
    sample: int | None = None,
    keep: frozenset[str] = frozenset(),
    estimate: bool = True,
    progress: Callable[[str, float], None] | None = None,
) -> Cloud:
    """Read a cloud from a file; the name's suffix tells the format.

    A mesh's vertices are points, or its faces are sampled. Positions are relative to the cloud's
    own centre. Missing normals are estimated, and points without a colour get one. Points without a
    finite position are dropped and counted (see ``assemble_cloud``), and so are several points at
    exactly 0, 0, 0 (see ``empty_returns``).

    Parameters
    ----------
    path
        PLY, PCD, LAS, LAZ, E57, NPZ, NPY; a mesh as OBJ, STL, OFF or GLB; or text: XYZ, XYZN,
        XYZRGB, PTS, PTX, TXT, ASC or CSV; also compressed by gzip. A pipe is read to its end; ``-``
        is the standard input.
    colour
        What colours a point: ``rgb``, ``height``, ``intensity``, ``classification`` or the name of
        a column; as a ``ColourBy`` with a colour map and a range too. None: the file's colours,
        else its intensity as grey, else one colour. ``Cloud.colour_key`` says what stands for what.
        Heights are along ``Cloud.up``, or the axis of the ``ColourBy``.
    format
        One of these formats, whatever the name is.
    sample
        Number of points that are spread evenly over the faces of a mesh; None: its vertices.
    keep
        Points that are drawn though they usually are not: see ``wanted.UNDRAWN``.
    estimate
        Whether missing normals are estimated; if not, they are 0.
    progress
        Called now and then with a stage, ``read`` or ``normals``, and the share of it that is done.
        A cloud whose normals are all there has no stage ``normals``.

    Raises
    ------
    InputError
        If the file is missing, unreadable, empty, truncated or otherwise damaged, of an unknown
        format, or has no x, y and z or no point with a finite position; if it lacks what is to
        colour a point, or there is no such colour map.
    """
    place = Path(path)
    up = usual_up(place, format)
    by = ColourBy(colour, up=up) if isinstance(colour, str) else colour
    check_map(by)
    read, normals = (
        None if progress is None else partial(progress, stage) for stage in ("read", "normals")
    )
    with open_cloud_file(place, Wanted(by, sample=sample, keep=keep), read, format) as source:
        columns = read_columns(source)
        if read is not None:
            read(1.0)
        return assemble_cloud(
            columns, cloud_name(place), up=up, estimate=estimate, progress=normals
        )


@contextmanager
def open_cloud_file(
    place: Path,
    wanted: Wanted = USUAL,
    progress: Progress | None = None,
    format: str | None = None,
) -> Iterator[Source]:
    """Open a cloud file; what goes wrong while it is open is told with its name.

    Raises
    ------
    InputError
        If it cannot be read, or its name has no suffix of a format that is read.
    """
    try:
        if place.is_dir():
            raise InputError("is a folder; give the name of a file")
        if str(place) != "-":
            place.stat()
        suffix = check_format(place, format)
        if wanted.sample is not None and suffix not in MESHES:
            raise InputError(f"has no faces to sample; meshes are {' '.join(MESHES)}")
        with np.errstate(all="ignore"), open_source(place, progress, wanted, suffix) as source:
            yield source
    except OSError as error:
        raise InputError(f"{place}: cannot be read: {error.strerror or error}") from None
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def read_columns(source: Source) -> Columns:
    """Return the columns of an open file of a known format; failures become ``InputError``."""
    with parser_errors(source):
        if source.wanted.sample is not None:
            return read_mesh(source)
        return FORMATS[source.suffix](source)


@contextmanager
def parser_errors(source: Source) -> Iterator[None]:
    """Turn what a parser raises, which may be of any type, into an ``InputError`` of one line."""
    kind = source.suffix[1:].upper()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a warning of a parser is about the file
            yield
    except (OSError, InputError):
        raise
    except MemoryError:
        raise InputError("does not fit the memory, or is damaged and claims to be huge") from None
    except Exception as error:
        # Parsers raise errors of many types for damaged files; a traceback would not help. Their
        # text may have several lines.
        text = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(f"cannot be read as {kind}; is it damaged? ({text})") from None
