"""The subject of a live view: a file or a built-in scene, read as ``splatline render`` does."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.upward import upward_of
from splatline.host.files.colouring import check_map, colour_scene
from splatline.host.files.listing import HEADERS, taken_for
from splatline.host.files.readers import open_cloud_file, read_cloud
from splatline.host.files.wanted import CLASSIFICATION, HEIGHT, INTENSITY, ColourBy
from splatline.host.scenes.scenes import load_scene

from .camera import Camera, fit_camera
from .events import DEFAULT_COLOUR
from .live_cloud import LiveCloud, Progress, live_cloud

__all__ = ["Subject"]

MOST_FIELDS = 40
"""Columns that are offered as colours."""


@dataclass(frozen=True)
class Subject:
    """A cloud's file or a built-in scene, and how it is read.

    Parameters
    ----------
    path
        The file; None: a scene.
    scene
        Name of the built-in scene, if there is no file.
    name
        What the cloud is called.
    format, sample, keep
        As of ``read_cloud``.
    fit, splat_size
        As of ``live_cloud``.
    orbit, fov, up
        As of ``fit_view``, of the first picture.
    target, distance
        As of ``look_at``, of the first picture; None: the whole cloud is seen.
    """

    path: Path | None = None
    scene: str = "terrain"
    name: str = "terrain"
    format: str | None = None
    sample: int | None = None
    keep: frozenset[str] = frozenset()
    fit: str = "bulk"
    splat_size: float | None = None
    orbit: tuple[float, float] = (30.0, 20.0)
    fov: float = 35.0
    up: str = "y"
    target: tuple[float, float, float] | None = None
    distance: float | None = None

    @property
    def upward(self) -> str | None:
        """The axis up if the first picture looks down or is level; else None."""
        return upward_of(self.orbit, self.up)

    def read(
        self,
        colour: ColourBy | None,
        progress: Progress = lambda text, share: None,
        base: LiveCloud | None = None,
    ) -> LiveCloud:
        """Return the cloud in some colours, ready to be drawn.

        Parameters
        ----------
        colour
            What colours the points; None: the file's own colours. Its ``up`` is the subject's.
        progress
            Told what is being done.
        base
            The cloud in other colours: everything else is taken from it, which is the same.

        Raises
        ------
        InputError
            If the file is bad, or lacks what is to colour a point.
        """
        check_map(colour)
        if colour is not None:
            colour = dataclasses.replace(colour, up=self.up)
        if self.path is None:
            progress(f"Making the scene {self.scene}", None)
            cloud = load_scene(self.scene).cloud
            cloud = cloud if colour is None else colour_scene(cloud, colour)
        elif base is not None:
            return base.recoloured(self._read(self.path, colour, progress, estimate=False))
        else:
            cloud = self._read(self.path, colour, progress, estimate=True)
        return live_cloud(cloud, fit=self.fit, splat_size=self.splat_size, progress=progress)

    def _read(
        self, path: Path, colour: ColourBy | None, progress: Progress, *, estimate: bool
    ) -> Cloud:
        """Read the file; without ``estimate`` missing normals are 0."""
        doing = {
            "read": f"Reading {path.name}",
            "normals": f"Estimating the normals of {path.name}",
        }
        return read_cloud(
            path,
            colour=colour,
            format=self.format,
            sample=self.sample,
            keep=self.keep,
            estimate=estimate,
            progress=lambda stage, share: progress(doing[stage], share),
        )

    def home(self, live: LiveCloud, size: tuple[int, int]) -> Camera:
        """Return the camera of the first picture, on an image of a size in pixels."""
        options: dict[str, Any] = {"orbit": self.orbit, "fov": self.fov, "up": self.up}
        if self.target is not None and self.distance is not None:
            return Camera(self.target, self.distance, *self.orbit, fov=self.fov, up=self.up)
        return fit_camera(live.cloud, live.discs.radii, size=size, **options)

    def colours(self) -> list[dict[str, str]]:
        """Return the fields that can colour a point: ``by``, and ``label`` for a person."""
        usual = [
            {"by": DEFAULT_COLOUR, "label": "its own colours"},
            {"by": HEIGHT, "label": "height"},
        ]
        if self.path is None or str(self.path) == "-":
            return usual
        return usual + [{"by": name, "label": name} for name in self._columns()][:MOST_FIELDS]

    def _columns(self) -> list[str]:
        """Return the names of a file's columns of numbers, as far as its header tells."""
        assert self.path is not None
        try:
            with open_cloud_file(self.path, format=self.format) as source:
                if source.suffix not in HEADERS:
                    return []
                listing = HEADERS[source.suffix](source)
        except InputError:
            return []
        if not listing.named:
            return []
        meaning, _ = taken_for(listing)
        taken = {name for name, what in meaning.items() if what != INTENSITY}
        single = [name for name in listing.types if listing.widths.get(name, 1) == 1]
        first = [INTENSITY] if INTENSITY in meaning.values() else []
        first += [name for name in single if name.lower() == CLASSIFICATION]
        others = [name for name in single if name not in taken and name.lower() not in first]
        return [*first, *others]
