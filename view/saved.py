"""Files that a live view gives: the picture, and its code words."""

from __future__ import annotations

import io
import tempfile
import zipfile
from pathlib import Path

from splatline.host.frame_file import save_frame, sidecar_path
from splatline.plots.figure import depth_levels, png_bytes
from splatline.sim.golden.multisample import average

from .draw import Drawing
from .outputs import SavedFile

__all__ = ["saved_picture", "saved_words"]


def saved_picture(drawing: Drawing, name: str, show: str) -> SavedFile:
    """Return a picture as a PNG: that of ``splatline render``, or of its ``--depth``."""
    if show == "depth":
        levels = depth_levels(average(drawing.rasters))
        return SavedFile(f"{name}-depth.png", "image/png", png_bytes(levels))
    return SavedFile(f"{name}.png", "image/png", png_bytes(drawing.rgba[..., :3]))


def saved_words(drawing: Drawing, name: str) -> SavedFile:
    """Return a picture's code words as a ZIP of frames, each with its sidecar.

    ``splatline play`` draws each of them. There is one for each sample and each tile.
    """
    frames = drawing.frames
    stream = io.BytesIO()
    with (
        tempfile.TemporaryDirectory(prefix="splatline-") as scratch,
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
    ):
        for number, frame in enumerate(frames, start=1):
            mark = f"-{number}" if len(frames) > 1 else ""
            path = Path(scratch) / f"{name}{mark}.frame"
            save_frame(frame, path)
            for file in (path, sidecar_path(path)):
                archive.write(file, file.name)
                file.unlink()
    return SavedFile(f"{name}-words.zip", "application/zip", stream.getvalue())
