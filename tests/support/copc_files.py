"""Small COPC files for tests."""

import struct

import laspy
import numpy as np

from splatline.cli.bench.large.make_copc import ENTRY, make_copc

__all__ = ["INFO_AT", "info_of", "make_hills", "pages_of"]

INFO_AT = 375 + 54
"""First byte of the octree's record: after the header and the record's own."""


def make_hills(folder, count, *, leaf=2000, page_level=2, seed=1, **fields):
    """Write hills in map coordinates, with noise and colours, as LAZ and as COPC."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 100, (2, count))
    z = 10 * np.sin(x / 12) * np.cos(y / 9) + rng.normal(0, 0.02, count)
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = [0.001] * 3, [5e5, 5e6, 0]
    las = laspy.LasData(header)
    las.x, las.y, las.z = x + 5e5, y + 5e6, z
    colours = np.stack([2.5 * x, 2.5 * y, np.full(count, 90.0)], axis=1)
    las.red, las.green, las.blue = (colours.astype(np.uint16) * 257).T
    las.gps_time = np.arange(count, dtype=float)
    for name, values in fields.items():
        las[name] = values
    plain, octree = folder / "hills.laz", folder / "hills.copc.laz"
    las.write(plain)
    make_copc(plain, octree, leaf=leaf, page_level=page_level)
    return plain, octree


def info_of(data):
    """Return the octree's centre, half side, spacing, and the place and size of its root's page."""
    *numbers, at, size = struct.unpack_from("<5d2Q", data, INFO_AT)
    return np.array(numbers[:3]), numbers[3], numbers[4], at, size


def pages_of(data):
    """Return the entries of all pages of the hierarchy, which may be changed: they are its end."""
    *_, at, _ = info_of(data)
    return np.frombuffer(data, ENTRY, offset=at)
