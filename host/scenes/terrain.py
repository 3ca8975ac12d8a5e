"""The scene ``terrain``: a real elevation model, coloured by height."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud

from .patches import Patch

__all__ = ["terrain_cloud", "terrain_patches"]

EXAGGERATION = 3.5
"""Heights are drawn this many times too high: 840 m of relief over 30 km would look flat."""

EARTH_RADIUS = 6_371_000.0
"""Mean radius in metres."""

SMOOTHING = 1.2
"""Standard deviation in steps of the grid."""

# Share of the range of heights -> red, green, blue. The steps of the ramp differ even with three
# bits a channel.
RAMP = (
    (0.00, (46, 120, 96)),
    (0.12, (104, 168, 92)),
    (0.30, (196, 206, 116)),
    (0.48, (236, 206, 120)),
    (0.64, (214, 150, 88)),
    (0.80, (170, 104, 76)),
    (0.92, (206, 196, 190)),
    (1.00, (255, 255, 255)),
)
MATERIALS = 24

_Floats = npt.NDArray[np.float64]


def terrain_cloud() -> Cloud:
    """Return the elevation model near Jacksboro, Tennessee, as points: x east, y north, z up.

    The grid is the USGS's: 344 x 403 heights in metres, three arc seconds apart. matplotlib carries
    it. Positions are in metres, with heights times ``EXAGGERATION``. Normals come from the grid's
    slope.
    """
    height, step_x, step_y = _heights()
    rows, columns = height.shape
    z = EXAGGERATION * height
    y, x = np.meshgrid(-step_y * np.arange(rows), step_x * np.arange(columns), indexing="ij")
    positions = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    middle = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    return Cloud(
        positions=positions - middle,
        normals=_grid_normals(z, step_x, step_y).reshape(-1, 3).astype(np.float32),
        colours=_hypsometric(height, height).reshape(-1, 3),
        two_sided=np.zeros(len(positions), np.bool_),
        origin=middle,
        name="terrain",
        dropped={},
        up="z",
    )


def terrain_patches() -> list[Patch]:
    """Return the surface between the grid's points: heights and normals are bilinear.

    The coordinates are shares of the area on a map: from west to east, and from north to south.
    """
    from scipy.ndimage import map_coordinates

    height, step_x, step_y = _heights()
    rows, columns = height.shape
    normals = _grid_normals(EXAGGERATION * height, step_x, step_y)

    def at(east: _Floats, south: _Floats) -> tuple[_Floats, _Floats, npt.NDArray[np.uint8]]:
        where = np.stack([south * (rows - 1), east * (columns - 1)])
        between = map_coordinates(height, where, order=1, mode="nearest")
        positions = np.stack(
            [step_x * where[1], -step_y * where[0], EXAGGERATION * between], axis=-1
        )
        found = np.stack(
            [map_coordinates(normals[..., k], where, order=1, mode="nearest") for k in range(3)],
            axis=-1,
        )
        found /= np.linalg.norm(found, axis=1, keepdims=True)
        return positions, found, _hypsometric(between, height)

    return [Patch(1.0, at)]


def _heights() -> tuple[_Floats, float, float]:
    """Return the grid's heights in metres, and its steps east and south."""
    from matplotlib.cbook import get_sample_data

    # asfileobj=False: the file object would read the archive as npz too, but leave it open.
    with np.load(get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)) as grid:
        height = grid["elevation"].astype(np.float64)
        step_x, step_y = math.radians(grid["dx"]), math.radians(grid["dy"])
        # Row 0 is the northern edge, which the file calls ymin.
        latitude = math.radians(0.5 * (float(grid["ymin"]) + float(grid["ymax"])))
    return height, step_x * (EARTH_RADIUS * math.cos(latitude)), step_y * EARTH_RADIUS


def _grid_normals(z: _Floats, step_x: float, step_y: float) -> _Floats:
    """Return the unit normals of the grid's points: shape (rows, columns, 3)."""
    down_y, along_x = np.gradient(_smooth(z), step_y, step_x)
    normals = np.stack([-along_x, down_y, np.ones_like(z)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return normals


def _smooth(z: _Floats) -> _Floats:
    """Return heights averaged with their neighbours', for the normals alone.

    The model's heights are whole metres, and its finest relief is smaller than a pixel. Unsmoothed,
    the shading of the plains would be noise.
    """
    from scipy.ndimage import gaussian_filter

    smooth: _Floats = gaussian_filter(z, SMOOTHING, mode="nearest")
    return smooth


def _hypsometric(height: _Floats, grid: _Floats) -> npt.NDArray[np.uint8]:
    """Return the ramp's colour of each height, in ``MATERIALS`` steps of the grid's range."""
    share = (height - grid.min()) / np.ptp(grid)
    level = np.minimum((share * MATERIALS).astype(np.int64), MATERIALS - 1)
    middles = (np.arange(MATERIALS) + 0.5) / MATERIALS
    shares = [share for share, _ in RAMP]
    channels = [
        np.interp(middles, shares, [colour[channel] for _, colour in RAMP]) for channel in range(3)
    ]
    palette = np.rint(np.stack(channels, axis=-1)).astype(np.uint8)
    return palette[level]
