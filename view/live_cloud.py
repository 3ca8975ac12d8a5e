"""A cloud that is drawn again and again: read once, indexed once for each palette."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Callable

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import far_points, without_far_points
from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.spacing import Discs, measure_discs
from splatline.host.cloud.upward import turn_upward
from splatline.host.shading.materials import find_materials
from splatline.host.visibility.block_index import Index, build_index

__all__ = ["LiveCloud", "Progress", "live_cloud"]

Progress = Callable[[str, float | None], None]
"""Called with what is done, in words for a person, and the share of it that is done."""


class LiveCloud:
    """A cloud with its discs, and an index for each size of palette.

    A survey that is seen from above has an index of its own: its upper side is the outer one.

    It may be used by several threads.

    Parameters
    ----------
    cloud
        The points.
    discs
        Their discs, as of ``measure_discs``.
    far_away
        Points that were left out, as they lie far from the rest.
    """

    def __init__(self, cloud: Cloud, discs: Discs, far_away: int = 0) -> None:
        self.cloud = cloud
        self.discs = discs
        self.far_away = far_away
        self._indexes: dict[tuple[int, str | None], Index] = {}
        self._lock = threading.Lock()

    def recoloured(self, read: Cloud) -> LiveCloud:
        """Return this cloud in the colours of the same file, read without its normals.

        Raises
        ------
        InputError
            If the file has other points now.
        """
        colours = read.colours
        if self.far_away:
            colours = colours[~far_points(read.positions)]
        if len(colours) != len(self.cloud):
            raise InputError(f"{self.cloud.name} has other points than before; start anew")
        cloud = dataclasses.replace(self.cloud, colours=colours, colour_key=read.colour_key)
        return LiveCloud(cloud, self.discs, self.far_away)

    def has_index(self, config: EngineConfig, upward: str | None = None) -> bool:
        """Return whether the index for an engine is built; see :meth:`index`."""
        return (config.material_bits, upward if self.cloud.survey else None) in self._indexes

    def index(self, config: EngineConfig, upward: str | None = None) -> Index:
        """Return the index for an engine; it is built when it is first asked for.

        Parameters
        ----------
        config
            The engine.
        upward
            The axis up if the eye looks down: a survey's estimated normals point up then; see
            ``turn_upward``. Other clouds do not depend on it.
        """
        with self._lock:
            upward = upward if self.cloud.survey else None
            key = config.material_bits, upward
            if key not in self._indexes:
                cloud = turn_upward(self.cloud, upward)
                materials = find_materials(cloud, 1 << config.material_bits)
                index = build_index(cloud, self.discs.radii, materials, self.discs.thin)
                self._indexes[key] = index
            return self._indexes[key]


def live_cloud(
    cloud: Cloud,
    *,
    fit: str = "bulk",
    splat_size: float | None = None,
    progress: Progress | None = None,
) -> LiveCloud:
    """Return a cloud ready to be drawn, with the discs and points of ``splatline render``.

    Parameters
    ----------
    cloud
        The points, as of ``read_cloud``.
    fit
        ``bulk``: without points far from the rest. ``all``: every point.
    splat_size
        Diameter of all discs, in the cloud's unit; None: from the points' spacing.
    progress
        Told how far the discs are.
    """
    far_away = 0
    if fit != "all":
        cloud, far_away = without_far_points(cloud)
    doing = f"Measuring the spacing of {len(cloud):,} points"
    share = None if progress is None else lambda part: progress(doing, part)
    return LiveCloud(cloud, measure_discs(cloud, splat_size, progress=share), far_away)
