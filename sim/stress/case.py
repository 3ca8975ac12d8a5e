"""Stress cases: a hard input, its bounds, and the measurement of its picture.

A case is data: a scene, its bounds, and optionally a base, which is a plain scene whose picture the
case must reproduce. ``measure`` draws both scenes and compares them with each other and with the
exact reference. The tests and the tables of ``docs/bench/stability.md`` use the same cases
(:mod:`splatline.sim.stress.themes`).
"""

from __future__ import annotations

import functools
import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster
from splatline.host.cloud.cloud import Cloud
from splatline.host.encode.quality import QUALITIES
from splatline.host.pipeline import make_frame
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.skips import DEFAULT_SKIPS
from splatline.host.visibility.view import View
from splatline.sim import golden, reference
from splatline.sim.reference.metrics import compare

from .word_checks import contested, faults, sorted_elements

__all__ = [
    "FAR",
    "REACH",
    "SOUND",
    "Bounds",
    "Case",
    "Outcome",
    "Scene",
    "Theme",
    "draw",
    "measure",
]

SAMPLES = 3
"""Samples of the reference along a side of a pixel; with an odd number one is at the centre."""

REACH = {"paper": 2, "fast": 2, "exact": 1}
"""Pixels by which a footprint may reach beyond the reference's. In ``exact`` the causes are the
pixel drawn for a splat that covers no centre, and the first-order projection. The other qualities
also round the centre to a whole pixel (half a pixel) and the diameter up (half a pixel more)."""


FAR = 0.01
"""Share of the depth range by which a depth is off in ``Bounds.depth_off``: 41 levels of 4095."""


@dataclass(frozen=True)
class Scene:
    """The arguments of ``host.make_frame``."""

    cloud: Cloud
    view: View
    radii: npt.NDArray[np.float64]
    lighting: Lighting = field(default_factory=Lighting)
    config: EngineConfig = PAPER


@dataclass(frozen=True)
class Bounds:
    """The bounds of a case; None means no bound.

    Parameters
    ----------
    same_words
        The code words equal the base's, bit for bit.
    same_elements
        The code words equal the base's, in any order within a line. The picture may then differ
        only at pixels where several elements have the nearest depth.
    changed
        Largest share of pixels that differ from the base's picture, in depth or colour.
    loss
        Largest loss of PSNR against the reference, compared with the base's picture, in dB.
    psnr
        Least PSNR against the reference in dB.
    holes
        Largest share of background among the pixels that the reference covers fully.
    stray
        Largest share of drawn pixels that are further than ``REACH`` from the reference's
        coverage.
    refused
        True: the input must be refused with ``InputError``, as nothing is in view. None: it may be
        refused, as no disc covers a pixel's centre.
    compared
        Whether the picture is compared with the reference.
    depth_off
        Largest share of pixels whose depth is more than ``FAR`` of the depth range from the
        reference's at their centre, of those that both draw; with planes alone.
    """

    same_words: bool = False
    same_elements: bool = False
    changed: float | None = None
    loss: float | None = None
    psnr: float | None = None
    holes: float | None = 0.01
    stray: float | None = 0.0
    refused: bool | None = False
    compared: bool = True
    depth_off: float | None = None


SOUND = Bounds(holes=None, stray=None)
"""Bounds that only require a sound stream: no code word outside the image, none at the background's
depth, and no more code words than the image can need."""


@dataclass(frozen=True)
class Case:
    """A hard input with its bounds.

    Parameters
    ----------
    name
        Name, unique within its theme.
    make
        Function that returns the scene.
    base
        Function that returns the plain scene whose picture the case must reproduce, if any.
    bounds
        Bounds of the case.
    rough
        Bounds for ``paper`` and ``fast``, if their rounding needs wider ones.
    """

    name: str
    make: Callable[[], Scene]
    base: Callable[[], Scene] | None = None
    bounds: Bounds = field(default_factory=Bounds)
    rough: Bounds | None = None

    def bounds_of(self, quality: str) -> Bounds:
        """Return the bounds for a quality."""
        return self.bounds if self.rough is None or quality == "exact" else self.rough


@dataclass(frozen=True)
class Theme:
    """Related cases, with the expected outcome and the reason for it.

    ``qualities`` are those in which they are drawn.
    """

    title: str
    expected: str
    cases: tuple[Case, ...]
    qualities: tuple[str, ...] = tuple(QUALITIES)


@dataclass(frozen=True)
class Outcome:
    """The measurements of a case in one quality; None if one does not apply.

    Parameters
    ----------
    changed
        Share of the pixels that differ from the base's picture.
    psnr_base_db
        PSNR against the base's picture; None if they are equal.
    psnr_db
        PSNR against the reference.
    holes, stray
        Shares; see :class:`Bounds`.
    refused
        The host found nothing to draw.
    drawn
        Number of drawn pixels.
    words
        Number of code words.
    depth_off
        Share; see :class:`Bounds`.
    problems
        Violated bounds and other faults, one line each.
    """

    changed: float | None = None
    psnr_base_db: float | None = None
    psnr_db: float | None = None
    holes: float | None = None
    stray: float | None = None
    refused: bool = False
    drawn: int = 0
    words: int = 0
    depth_off: float | None = None
    problems: tuple[str, ...] = ()


def draw(scene: Scene, quality: str, skips: frozenset[str] = DEFAULT_SKIPS) -> tuple[Frame, Raster]:
    """Return a scene's frame and picture; a floating-point warning of numpy is an error."""
    with np.errstate(all="raise"):
        frame = make_frame(
            scene.cloud,
            scene.view,
            radii=scene.radii,
            lighting=scene.lighting,
            config=scene.config,
            quality=quality,
            skips=skips,
        )
    return frame, golden.render(frame)


def measure(case: Case, quality: str) -> Outcome:
    """Draw a case, compare it with base and reference, and check its bounds.

    Parameters
    ----------
    case
        The case.
    quality
        One of ``host.encode.quality.QUALITIES``.
    """
    bounds = case.bounds_of(quality)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            scene = case.make()
            frame, picture = draw(scene, quality)
    except InputError as error:
        refused = (f"refused: {error}",) if bounds.refused is False else ()
        return Outcome(refused=True, problems=refused)
    except Exception as error:  # any error is a result of the case
        return Outcome(problems=(f"raised {type(error).__name__}: {error}",))
    problems = faults(frame, scene.cloud, scene.view, scene.radii, quality)
    if bounds.refused:
        problems.append("drawn, though nothing is in view")
    psnr = holes = stray = changed = psnr_base = depth_off = None
    if bounds.compared:
        truth = _truth(scene)
        errors = compare(picture, truth)
        psnr, holes = errors["psnr_db"], errors["hole_fraction"]
        stray = _stray_share(picture, truth.coverage > 0.0, scene, REACH[quality])
    if bounds.depth_off is not None:
        depth_off = _depth_off(picture, scene, frame.counts["depth_range"])
    if case.base is not None:
        base_frame, base, before = _plain(case.base, quality)
        changed = picture.mismatches(base) / picture.depth.size
        psnr_base = _psnr(picture, base)
        if bounds.same_words and not np.array_equal(frame.codewords, base_frame.codewords):
            problems.append("the code words differ from the base's")
        if bounds.same_elements:
            if not np.array_equal(sorted_elements(frame), sorted_elements(base_frame)):
                problems.append("the elements differ from the base's")
            if not contested(base_frame)[picture.differs(base)].all():
                problems.append("pixels differ that no two elements tie for")
        if bounds.loss is not None:
            least = (math.inf if before is None else before) - bounds.loss
            _hold(problems, "PSNR", psnr, least=least)
    _hold(problems, "share of pixels changed", changed, most=bounds.changed)
    _hold(problems, "PSNR", psnr, least=bounds.psnr)
    _hold(problems, "share of holes", holes, most=bounds.holes)
    _hold(problems, "share of stray pixels", stray, most=bounds.stray)
    _hold(problems, "share of depths off", depth_off, most=bounds.depth_off)
    return Outcome(
        changed=changed,
        psnr_base_db=psnr_base,
        psnr_db=psnr,
        holes=holes,
        stray=stray,
        drawn=int(picture.drawn.sum()),
        words=len(frame.codewords),
        depth_off=depth_off,
        problems=tuple(problems),
    )


@functools.lru_cache(maxsize=16)  # many cases have the same base
def _plain(base: Callable[[], Scene], quality: str) -> tuple[Frame, Raster, float | None]:
    """Return a base's frame, its picture and that picture's PSNR against the reference."""
    scene = base()
    frame, picture = draw(scene, quality)
    return frame, picture, compare(picture, _truth(scene))["psnr_db"]


def _truth(scene: Scene) -> reference.Reference:
    """Return a scene's reference picture."""
    return reference.render(scene.cloud, scene.view, scene.radii, scene.lighting, samples=SAMPLES)


def _depth_off(picture: Raster, scene: Scene, limits: tuple[float, float]) -> float | None:
    """Return the share of pixels whose depth is off, of those that the reference draws too."""
    exact = reference.render(scene.cloud, scene.view, scene.radii, scene.lighting, samples=1)
    both = picture.drawn & (exact.coverage > 0.0)
    if not both.any():
        return None
    span = limits[1] - limits[0]
    true = (exact.depth[both] - limits[0]) / span if span > 0.0 else np.zeros(both.sum())
    largest = picture.config.background_depth - 1
    off = np.abs(picture.depth[both] / largest - np.clip(true, 0.0, 1.0)) > FAR
    return float(np.mean(off))


def _stray_share(
    picture: Raster, covered: npt.NDArray[np.bool_], scene: Scene, reach: int
) -> float | None:
    """Return the share of drawn pixels that are further than ``reach`` from the allowed pixels.

    Allowed are the pixels that the reference covers, and the pixel of every point, since a disc
    that lies between the samples or is seen edge on is still drawn as one pixel.
    """
    from scipy.ndimage import maximum_filter

    drawn = picture.drawn
    if not drawn.any():
        return None
    view = scene.view
    centres = (scene.cloud.positions - view.eye) @ view.axes.T
    centres = centres[centres[:, 2] >= view.near]
    with np.errstate(over="ignore"):  # beyond any image, however far
        point = centres[:, :2] / centres[:, 2:] * view.focal + view.middle
    point = point[((point >= 0.0) & (point < [view.width, view.height])).all(axis=1)]
    allowed = covered.copy()
    allowed[point[:, 1].astype(np.int64), point[:, 0].astype(np.int64)] = True
    near: npt.NDArray[Any] = maximum_filter(allowed, 2 * reach + 1)
    return float(np.count_nonzero(drawn & ~near) / np.count_nonzero(drawn))


def _psnr(picture: Raster, base: Raster) -> float | None:
    """Return the PSNR between two pictures in dB, or None if they are equal."""
    error = float(np.mean((picture.to_rgb() - base.to_rgb()) ** 2))
    return -10.0 * math.log10(error) if error > 0.0 else None


def _hold(
    problems: list[str],
    what: str,
    value: float | None,
    *,
    most: float | None = None,
    least: float | None = None,
) -> None:
    """Add a problem if a value violates its bound; None is a perfect value or no value."""
    if value is None:
        return
    if most is not None and not value <= most:
        problems.append(f"{what}: {value:.3g}, at most {most:.3g} expected")
    if least is not None and not value >= least:
        problems.append(f"{what}: {value:.4g} dB, at least {least:.4g} expected")
