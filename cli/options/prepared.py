"""Prepared pictures: the frames or the tiles of a render request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from splatline.contract.frame import Frame
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.cloud.spacing import Discs
    from splatline.host.large.cluster_tiles import ClusterTiles
    from splatline.host.large.joined_tiles import JoinedTiles
    from splatline.host.picture_tiles.frames import TiledPicture
    from splatline.host.visibility.view import View

    Picture: TypeAlias = TiledPicture | JoinedTiles | ClusterTiles
    """A picture in tiles."""

__all__ = ["PreparedFrames", "PreparedTiles"]


@dataclass(frozen=True)
class PreparedFrames:
    """The frames of a render request.

    Parameters
    ----------
    frames
        One frame for each sample of a pixel.
    view
        The camera.
    camera
        Orbit, field of view, up axis and zoom that were used, for the statistics; of a camera that
        looks at a point also target and distance.
    dropped
        Points left out when the cloud was read, by reason.
    colour_key
        What the colours stand for; see ``Cloud.colour_key``.
    notes
        What a person should know about the cloud, each in one line.
    far_away
        Points far from the rest that are not drawn.
    facts
        Further statistics.
    cloud, discs
        The points and their discs. None for a cloud that is drawn in parts.
    """

    frames: list[Frame]
    view: View
    camera: dict[str, Any]
    dropped: dict[str, int]
    colour_key: dict[str, Any]
    notes: list[str]
    far_away: int = 0
    facts: dict[str, Any] = field(default_factory=dict)
    cloud: Cloud | None = None
    discs: Discs | None = None


@dataclass(frozen=True)
class PreparedTiles:
    """The tiles of a render request.

    Parameters
    ----------
    picture
        The tiles; their frames are made as they are asked for, or lie in memory.
    camera, dropped, colour_key, notes, far_away
        See :class:`PreparedFrames`.
    facts
        Returns further statistics, once the tiles are drawn.
    """

    picture: Picture
    camera: dict[str, Any]
    dropped: dict[str, int]
    colour_key: dict[str, Any]
    notes: list[str]
    far_away: int = 0
    facts: Callable[[], dict[str, Any]] = dict
