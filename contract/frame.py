"""A frame ready for an engine: code words, tables and the size of the image."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from .config import ROWS, EngineConfig
from .errors import InputError
from .presets import PAPER

__all__ = ["Frame", "Tables", "are_control", "check_codewords", "check_tables"]


@dataclass(frozen=True)
class Tables:
    """The tables that an engine gets before a frame (``docs/contract.md``, "Tables").

    Parameters
    ----------
    ambient
        I0 of red, green and blue, with ``colour_shift`` fraction bits: shape (3,), int64.
    diffuse, specular
        kd and ks of each material and channel: shape (2**material_bits, 3), int64.
    """

    ambient: npt.NDArray[np.int64]
    diffuse: npt.NDArray[np.int64]
    specular: npt.NDArray[np.int64]


@dataclass(frozen=True)
class Frame:
    """All data that an engine needs to draw one image.

    Parameters
    ----------
    codewords
        The stream, its end-of-frame word included: uint64, shape (n,). Plane words have the shape
        (n, 2): the low 64 bits, then the high 32 bits, as they lie in 128 bits on AXI.
    tables
        Material table and base colour.
    width, height
        Size of the image in pixels.
    config
        Configuration of the engine for which the code words are made.
    counts
        Statistics of the points that were drawn and left out: plain numbers and dictionaries.
    """

    codewords: npt.NDArray[np.uint64]
    tables: Tables
    width: int
    height: int
    config: EngineConfig = PAPER
    counts: dict[str, Any] = field(default_factory=dict)


def check_tables(tables: Tables, config: EngineConfig) -> None:
    """Raise ``InputError`` unless the tables fit an engine of a configuration."""
    coefficients = ((1 << config.material_bits, 3), config.coefficient_bits)
    for name, table, (shape, bits) in (
        ("ambient", tables.ambient, ((3,), config.ambient_bits)),
        ("diffuse", tables.diffuse, coefficients),
        ("specular", tables.specular, coefficients),
    ):
        if table.shape != shape:
            raise InputError(f"the table {name!r} must have the shape {shape}, not {table.shape}")
        if table.min() < 0 or table.max() >> bits:
            raise InputError(f"the table {name!r} has values that do not fit {bits} bits")


def check_codewords(codewords: npt.NDArray[np.uint64], config: EngineConfig) -> None:
    """Raise ``InputError`` unless code words have the shape of a configuration's.

    That is (n,), and (n, 2) for an engine with planes.
    """
    halves = (2,) if config.plane else ()
    if codewords.ndim != 1 + len(halves) or codewords.shape[1:] != halves:
        wanted = "(n, 2)" if config.plane else "(n,)"
        raise InputError(
            f"code words of preset {config.name} must have the shape {wanted},"
            f" not {codewords.shape}"
        )


def are_control(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.bool_]:
    """Return where the control words are: they have MODE 1, and every row is empty.

    Parameters
    ----------
    words
        Code words, or the low halves of plane words: shape (n,), uint64.
    """
    control = words >> np.uint64(config.mode.lsb) & np.uint64(1) == 1
    for row in range(ROWS):
        first, last = config.first(row), config.last(row)
        begins = words >> np.uint64(first.lsb) & np.uint64(first.mask)
        ends = words >> np.uint64(last.lsb) & np.uint64(last.mask)
        control &= begins > ends
    return control
