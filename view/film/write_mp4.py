"""MP4: H.264 by x264, through PyAV."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from splatline.contract.errors import InputError, install_hint

if TYPE_CHECKING:
    from .form import Form, Pixels

__all__ = ["check_mp4", "write_mp4"]

BT709 = 1
"""The number of ITU-T H.273 for the primaries, the transfer function and the matrix of BT.709."""

LIMITED = 1
"""FFmpeg's number for levels of 16 to 235."""

WORST, BEST = 51, 11
"""Rate factors of x264 for the fidelities 0 and 100."""


def check_mp4(form: Form) -> None:
    """Raise ``InputError`` if a film cannot be an MP4, or PyAV is not installed."""
    width, height = form.size
    if width % 2 or height % 2:
        even = f"{width + width % 2}x{height + height % 2}"
        raise InputError(
            f"an MP4 has an even width and height, as each of its colours covers 2 x 2 pixels;"
            f" take the size {even}, not {width}x{height}"
        )
    try:
        import av  # noqa: F401
    except ModuleNotFoundError:
        hint = install_hint("film")
        raise InputError(f"an MP4 needs PyAV: {hint}; or write a .webp or a .gif") from None


def write_mp4(frames: Iterator[Pixels], stream: IO[bytes], form: Form) -> None:
    """Write a film that players, browsers and slides show: H.264, 4:2:0, tagged as BT.709.

    The index stands first in the file, so that a browser need not fetch it whole to begin. It is
    known at the end, so the film is made in a temporary folder.

    Parameters
    ----------
    frames, stream, form
        As of ``Write``.
    """
    import av

    with tempfile.TemporaryDirectory(prefix="splatline-film-") as folder:
        file = Path(folder) / "film.mp4"
        with av.open(file, "w", format="mp4", options={"movflags": "+faststart"}) as container:
            video = _add_video(container, form)
            for number, pixels in enumerate(frames):
                frame = av.VideoFrame.from_ndarray(pixels, format="rgb24").reformat(
                    format="yuv420p",
                    src_colorspace="ITU709",
                    dst_colorspace="ITU709",
                    src_color_range="JPEG",
                    dst_color_range="MPEG",
                )
                frame.pts = number
                frame.time_base = video.codec_context.time_base
                container.mux(video.encode(frame))
            container.mux(video.encode())
        with file.open("rb") as made:
            shutil.copyfileobj(made, stream)


def _add_video(container: Any, form: Form) -> Any:
    """Add the stream of pictures to a container."""
    rate = Fraction(form.fps).limit_denominator(1001)
    factor = WORST + (BEST - WORST) * form.fidelity / 100.0
    video = container.add_stream("libx264", rate=rate, options={"crf": f"{factor:g}"})
    video.width, video.height = form.size
    video.pix_fmt = "yuv420p"
    context = video.codec_context
    context.time_base = 1 / rate
    context.color_primaries = context.color_trc = context.colorspace = BT709
    context.color_range = LIMITED
    return video
