"""Stress cases: a hard input, the picture it must give, and what is measured of it.

A case is data: a scene, perhaps a plain scene whose picture it must repeat, and bounds. ``measure``
draws both and compares them with each other and with the exact reference. The tests and the table
in ``docs/bench/stability.md`` are made from the same cases
(:mod:`splatline.sim.stress.clouds_moved`).
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
from splatline.host.pipeline import make_frame
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.view import View
from splatline.sim import golden, reference
from splatline.sim.reference.metrics import compare

from .word_checks import contested, faults, sorted_elements

__all__ = ["REACH", "SOUND", "Bounds", "Case", "Outcome", "Scene", "Theme", "draw", "measure"]

SAMPLES = 3
"""Of the reference, a side of a pixel: an odd number has the pixel's centre among them."""

REACH = {"paper": 2, "fast": 2, "exact": 1}
"""Pixels by which a footprint may reach beyond the truth. ``exact``: the pixel that holds a splat
too small to cover a centre, and what the first order of the projection leaves out. The others round
a centre to a whole pixel (half a pixel) and a diameter up (half a pixel more) on top of that."""


@dataclass(frozen=True)
class Scene:
    """What is drawn: the arguments of ``host.make_frame``."""

    cloud: Cloud
    view: View
    radii: npt.NDArray[np.float64]
    lighting: Lighting = field(default_factory=Lighting)
    config: EngineConfig = PAPER


@dataclass(frozen=True)
class Bounds:
    """What a case must keep to; None is not asked for.

    Parameters
    ----------
    same_words
        The code words are those of the base, every bit.
    same_elements
        The code words are those of the base, in any order within a line. The picture then differs
        where several elements have the nearest depth, and nowhere else.
    changed
        Largest share of the pixels that differ from the base's picture, in depth or colour.
    loss
        Most dB of PSNR against the reference that the base's picture has and this one lacks.
    psnr
        Least PSNR against the reference in dB.
    holes
        Largest share of wholly covered pixels that are left background.
    stray
        Largest share of the drawn pixels that are further than ``REACH`` from all the reference
        covers.
    refused
        The input must be refused with ``InputError``: nothing of it is in view. None: it may be,
        since no disc covers a pixel's centre.
    compared
        With the reference.
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


SOUND = Bounds(holes=None, stray=None)
"""The stream is sound, whatever it shows: no word outside the image, none at the background's
depth, not more than the image can need."""


@dataclass(frozen=True)
class Case:
    """A hard input, by name.

    Parameters
    ----------
    name
        Unique within its theme.
    make
        Returns the scene.
    base
        Returns the plain scene whose picture it must give again, if there is one.
    bounds
        What holds.
    rough
        What holds in ``paper`` and ``fast`` instead, if their rounding allows less.
    """

    name: str
    make: Callable[[], Scene]
    base: Callable[[], Scene] | None = None
    bounds: Bounds = field(default_factory=Bounds)
    rough: Bounds | None = None

    def bounds_of(self, quality: str) -> Bounds:
        """Return what holds in a quality."""
        return self.bounds if self.rough is None or quality == "exact" else self.rough


@dataclass(frozen=True)
class Theme:
    """Cases that belong together, and what is expected of them and why."""

    title: str
    expected: str
    cases: tuple[Case, ...]


@dataclass(frozen=True)
class Outcome:
    """What came of a case in one quality; None where it does not apply.

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
        Pixels.
    words
        Length of the stream.
    problems
        What is not as expected, one line each.
    """

    changed: float | None = None
    psnr_base_db: float | None = None
    psnr_db: float | None = None
    holes: float | None = None
    stray: float | None = None
    refused: bool = False
    drawn: int = 0
    words: int = 0
    problems: tuple[str, ...] = ()


def draw(scene: Scene, quality: str) -> tuple[Frame, Raster]:
    """Return a scene's frame and picture; whatever numpy would warn of is an error."""
    with np.errstate(all="raise"):
        frame = make_frame(
            scene.cloud,
            scene.view,
            radii=scene.radii,
            lighting=scene.lighting,
            config=scene.config,
            quality=quality,
        )
    return frame, golden.render(frame)


def measure(case: Case, quality: str) -> Outcome:
    """Draw a case, compare it, and list what is not as expected.

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
    except Exception as error:  # whatever it is, it is what came of the case
        return Outcome(problems=(f"raised {type(error).__name__}: {error}",))
    problems = faults(frame, scene.cloud, scene.view, scene.radii, quality)
    if bounds.refused:
        problems.append("drawn, though nothing is in view")
    psnr = holes = stray = changed = psnr_base = None
    if bounds.compared:
        truth = _truth(scene)
        errors = compare(picture, truth)
        psnr, holes = errors["psnr_db"], errors["hole_fraction"]
        stray = _stray_share(picture, truth.coverage > 0.0, scene, REACH[quality])
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
    return Outcome(
        changed=changed,
        psnr_base_db=psnr_base,
        psnr_db=psnr,
        holes=holes,
        stray=stray,
        drawn=int(picture.drawn.sum()),
        words=len(frame.codewords),
        problems=tuple(problems),
    )


@functools.lru_cache(maxsize=16)  # many cases have the same base
def _plain(base: Callable[[], Scene], quality: str) -> tuple[Frame, Raster, float | None]:
    """Return a base's frame, its picture and that picture's PSNR against the reference."""
    scene = base()
    frame, picture = draw(scene, quality)
    return frame, picture, compare(picture, _truth(scene))["psnr_db"]


def _truth(scene: Scene) -> reference.Reference:
    return reference.render(scene.cloud, scene.view, scene.radii, scene.lighting, samples=SAMPLES)


def _stray_share(
    picture: Raster, covered: npt.NDArray[np.bool_], scene: Scene, reach: int
) -> float | None:
    """Return how much of what is drawn lies further than ``reach`` pixels from all that should.

    That is what the reference covers, and the pixel of every point: a disc between the samples, or
    edge on, is still drawn as one pixel.
    """
    from scipy.ndimage import maximum_filter

    drawn = picture.drawn
    if not drawn.any():
        return None
    view = scene.view
    centres = (scene.cloud.positions - view.eye) @ view.axes.T
    centres = centres[centres[:, 2] >= view.near]
    with np.errstate(over="ignore"):  # beyond any image, however far
        place = centres[:, :2] / centres[:, 2:] * view.focal + view.middle
    place = place[((place >= 0.0) & (place < [view.width, view.height])).all(axis=1)]
    allowed = covered.copy()
    allowed[place[:, 1].astype(np.int64), place[:, 0].astype(np.int64)] = True
    near: npt.NDArray[Any] = maximum_filter(allowed, 2 * reach + 1)
    return float(np.count_nonzero(drawn & ~near) / np.count_nonzero(drawn))


def _psnr(picture: Raster, base: Raster) -> float | None:
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
    """Note a value that is out of its bound; None is a perfect one (or there is nothing)."""
    if value is None:
        return
    if most is not None and not value <= most:
        problems.append(f"{what}: {value:.3g}, at most {most:.3g} expected")
    if least is not None and not value >= least:
        problems.append(f"{what}: {value:.4g} dB, at least {least:.4g} expected")
