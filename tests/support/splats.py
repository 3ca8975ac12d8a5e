"""Splats by their numbers, and pictures of their words."""

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame, Tables
from splatline.contract.presets import PAPER
from splatline.host.encode.encode import Encoded
from splatline.host.encode.sort_by_line import sort_by_line
from splatline.host.shading.normal_levels import level_slopes
from splatline.host.visibility.splats import SPLAT, Splats
from splatline.sim import golden

__all__ = ["picture_of", "splats_of"]


def splats_of(column, line, diameter, shape=32 * 64 + 32, slope=None) -> Splats:
    """Return splats with slopes given, or with the levels' own."""
    column = np.atleast_1d(np.asarray(column, np.float32))
    data = np.zeros(len(column), SPLAT)
    data["column"], data["line"], data["diameter"] = column, line, diameter
    if slope is None:
        slopes = level_slopes()
        slope = np.stack([slopes[np.asarray(shape) // 64], slopes[np.asarray(shape) % 64]], -1)
    data["slope_x"], data["slope_y"] = np.moveaxis(np.asarray(slope, np.float32), -1, 0)
    data["depth"] = 1.0
    return Splats.of(data)


def picture_of(encoded: Encoded, width: int, height: int, config: EngineConfig = PAPER):
    """Return golden's picture of words, with black tables."""
    stream, _ = sort_by_line(encoded, config)
    materials = np.zeros((1 << config.material_bits, 3), np.int64)
    tables = Tables(np.zeros(3, np.int64), materials, materials)
    return golden.render(Frame(stream, tables, width, height, config))
