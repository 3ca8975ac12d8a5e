"""Frames on disk: a file of code words as the engine takes them, and a JSON sidecar."""

from __future__ import annotations

import dataclasses
import json
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.atomic_write import atomic_write
from splatline.contract.config import COMPACT, EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame, Tables, are_control, check_tables
from splatline.contract.plane import LOW_BITS
from splatline.host.visibility.view import View

__all__ = ["describe_frame", "load_frame", "save_frame", "sidecar_path"]

FORMAT = "splatline-frame"
VERSION = 2


def sidecar_path(path: str | Path) -> Path:
    """Return the path of a frame's sidecar: the frame's path with ``.json`` added."""
    path = Path(path)
    return path.with_name(path.name + ".json")


def save_frame(
    frame: Frame,
    path: str | Path,
    *,
    view: View | None = None,
    extra: dict[str, Any] | None = None,
) -> None:
    """Write a frame's code words, little-endian 64-bit words, and its sidecar.

    The sidecar has their checksum: after a run that was stopped, the two may not belong together.
    Plane words are written as little-endian 128-bit words, as on AXI.

    Parameters
    ----------
    frame
        The frame to write.
    path
        File for the code words; the sidecar's name is this and ``.json``.
    view
        The camera that the frame was made with, for the record.
    extra
        Further plain values for the sidecar, by name.

    Raises
    ------
    InputError
        If a file cannot be written. No file is left half-written.
    """
    data = np.ascontiguousarray(frame.codewords, "<u8").tobytes()
    sidecar = {
        "format": FORMAT,
        "version": VERSION,
        "width": frame.width,
        "height": frame.height,
        "crc32": zlib.crc32(data),
        "config": _describe_config(frame.config),
        "tables": {
            field.name: getattr(frame.tables, field.name).tolist()
            for field in dataclasses.fields(Tables)
        },
        "counts": frame.counts,
        "view": None if view is None else _describe_view(view),
        **(extra or {}),
    }
    text = json.dumps(sidecar, indent=1).encode()
    atomic_write(path, data)
    atomic_write(sidecar_path(path), text + b"\n")


def load_frame(path: str | Path) -> Frame:
    """Read a frame that :func:`save_frame` wrote.

    Raises
    ------
    InputError
        If the code words or the sidecar are missing, damaged, or do not fit each other.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from None
    beside = sidecar_path(path)
    try:
        sidecar = json.loads(beside.read_text())
    except OSError as error:
        raise InputError(
            f"cannot read {beside}, which tells what {path.name} needs: {error.strerror or error}"
        ) from None
    except ValueError:
        raise InputError(f"{beside} is not valid JSON; encode the frame again") from None
    if not isinstance(sidecar, dict) or sidecar.get("format") != FORMAT:
        raise InputError(f"{beside} does not describe a frame; encode the frame again")
    if sidecar.get("version") != VERSION:
        raise InputError(
            f"{beside} has version {sidecar.get('version')!r}; this Splatline reads {VERSION};"
            " encode the frame again"
        )
    described = sidecar.get("config")
    size = 16 if isinstance(described, dict) and described.get("plane") is True else 8
    if len(data) % size:
        raise InputError(
            f"{path} has {len(data)} bytes, not whole {8 * size}-bit words; it is cut short"
        )
    codewords = np.frombuffer(data, "<u8").astype(np.uint64)
    try:
        frame = _frame_of(codewords if size == 8 else codewords.reshape(-1, 2), sidecar)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{beside} is damaged ({error}); encode the frame again") from None
    low = _low_halves(frame)
    if not len(low) or not _is_end(int(low[-1]), frame.config):
        raise InputError(f"{path} does not end with an end-of-frame word; it is cut short")
    if sidecar.get("crc32", zlib.crc32(data)) != zlib.crc32(data):
        raise InputError(f"{path} is not what {beside} describes; encode the frame again")
    return frame


def describe_frame(frame: Frame) -> dict[str, Any]:
    """Return a frame's size, preset, counts of code words by kind, and ranges of X and Z.

    Compact words are a kind of symmetric words, and count as these too. Of an engine with planes Z
    is in fractions of a level.
    """
    config = frame.config
    words = _low_halves(frame)
    mode = words >> np.uint64(config.mode.lsb) & np.uint64(1)
    control = are_control(words, config)
    drawn = words[~control]

    def span(name: str) -> list[int] | None:
        field = getattr(config, name)
        source, lsb = drawn, field.lsb
        if lsb >= LOW_BITS:
            source, lsb = frame.codewords[~control, 1], lsb - LOW_BITS
        values = source >> np.uint64(lsb) & np.uint64(field.mask)
        return [int(values.min()), int(values.max())] if len(values) else None

    return {
        "width": frame.width,
        "height": frame.height,
        "preset": config.name,
        "codewords": len(words),
        "control_words": int(control.sum()),
        "symmetric_words": int((~control & (mode == 0)).sum()),
        "compact_words": int(_are_compact(drawn, config).sum()),
        "fraction_words": int((~control & (mode == 1)).sum()),
        "materials": int(np.count_nonzero(frame.tables.diffuse.any(axis=1))),
        "x_range": span("x"),
        "z_range": span("z"),
        "counts": frame.counts,
    }


def _low_halves(frame: Frame) -> npt.NDArray[np.uint64]:
    """Return the low 64 bits of a frame's code words."""
    return frame.codewords[:, 0] if frame.config.plane else frame.codewords


def _describe_config(config: EngineConfig) -> dict[str, Any]:
    """Return what code words depend on: not the memories of the hardware that draws them."""
    described = dataclasses.asdict(config)
    del described["memory"]
    return described


def _frame_of(codewords: npt.NDArray[np.uint64], sidecar: dict[str, Any]) -> Frame:
    """Return the frame that a sidecar describes; raise ``ValueError`` if it cannot be one."""
    config = EngineConfig(**sidecar["config"])
    width, height = sidecar["width"], sidecar["height"]
    for name, value, most in (
        ("width", width, config.max_width),
        ("height", height, config.max_height),
    ):
        if not isinstance(value, int) or not 1 <= value <= most:
            raise ValueError(f"a {name} of {value!r}")
    tables = Tables(
        **{name: np.array(values, np.int64) for name, values in sidecar["tables"].items()}
    )
    check_tables(tables, config)
    counts = sidecar.get("counts") or {}
    if not isinstance(counts, dict) or not isinstance(counts.get("seconds", {}), dict):
        raise ValueError("the counts")
    return Frame(codewords, tables, width, height, config, counts)


def _are_compact(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.bool_]:
    """Return where the compact words are: nowhere for an engine without a shape ROM."""
    if config.shapes == "none":
        return np.zeros(len(words), np.bool_)
    mark = config.compact_mark
    mask = 1 << config.mode.lsb | mark.mask << mark.lsb
    return words & np.uint64(mask) == np.uint64(COMPACT << mark.lsb)


def _is_end(word: int, config: EngineConfig) -> bool:
    """Return whether a code word ends a frame."""
    is_control = bool(are_control(np.array([word], np.uint64), config)[0])
    return is_control and bool(word >> config.control_end.lsb & 1)


def _describe_view(view: View) -> dict[str, Any]:
    """Return a view as plain values."""
    return {
        "eye": view.eye.tolist(),
        "axes": view.axes.tolist(),
        "focal": view.focal,
        "width": view.width,
        "height": view.height,
        "near": view.near,
        "shift": [float(value) for value in view.shift],
    }
