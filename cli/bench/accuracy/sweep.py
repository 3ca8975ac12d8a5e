"""The pictures of ``splatline bench accuracy``: every combination that is measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

__all__ = [
    "FLOAT",
    "FLOAT_ONE_DEPTH",
    "Run",
    "Sweep",
    "budgeted",
    "plan",
    "qualities_of",
    "way",
]

FLOAT = "float"
FLOAT_ONE_DEPTH = "float, one depth a splat"
"""Qualities without an engine: one exact sample a pixel, and the same with one depth a splat."""


def way(quality: str, samples: int) -> str:
    """Return the name of a quality with a number of samples a pixel."""
    return quality if samples == 1 else f"{quality} \N{MULTIPLICATION SIGN}{samples}"


@dataclass(frozen=True)
class Sweep:
    """The pictures to measure.

    Parameters
    ----------
    paths, scenes
        Cloud files and built-in scenes.
    views
        Orbits; empty: each scene's own orbit, and the default orbit for a cloud file.
    size
        Size of the image.
    splats
        Median diameters of the splats in pixels; None: the points' own spacing.
    presets
        Engines for splats of the points' spacing.
    fewer_presets
        Engines for splats of other sizes.
    ladders
        Sizes of splats that get an error budget.
    sampled
        Sizes of splats that are also drawn with several samples a pixel.
    samples
        Numbers of samples a pixel, by preset.
    repeats
        Calls of host and golden renderer; the fastest one counts.
    """

    paths: tuple[Path, ...]
    scenes: tuple[str, ...]
    views: tuple[tuple[float, float], ...]
    size: tuple[int, int] = (512, 512)
    splats: tuple[float | None, ...] = (None, 1.5, 3.5, 7.0, 14.0)
    presets: tuple[str, ...] = ("paper", "rgb24", "depth12", "plane")
    fewer_presets: tuple[str, ...] = ("paper", "rgb24", "plane")
    ladders: tuple[float | None, ...] = (None, 3.5, 7.0)
    sampled: tuple[float | None, ...] = (None, 3.5, 7.0)
    samples: Mapping[str, tuple[int, ...]] = field(
        default_factory=lambda: {"paper": (4, 16), "rgb24": (4, 16), "plane": (4, 16)}
    )
    repeats: int = 3

    def total(self) -> int:
        """Return the number of pictures that will be compared."""
        each = sum(len(plan(self, splats)) + _budget_steps(self, splats) for splats in self.splats)
        return each * (len(self.scenes) + len(self.paths)) * max(len(self.views), 1)


@dataclass(frozen=True)
class Run:
    """One picture to draw.

    Parameters
    ----------
    quality
        Quality of the host, or a float quality.
    preset
        The engine; None for a float quality.
    switched
        A skip that differs from the host's default, if any.
    samples
        Samples a pixel, each from a frame of its own.
    """

    quality: str
    preset: str | None = None
    switched: str | None = None
    samples: int = 1


def plan(sweep: Sweep, splats: float | None) -> list[Run]:
    """Return the pictures to draw for a size of splats."""
    from splatline.host.encode.quality import DEFAULT_QUALITY, QUALITIES
    from splatline.host.visibility.skips import SKIPS

    presets = sweep.presets if splats is None else sweep.fewer_presets
    runs = [Run(FLOAT), Run(FLOAT_ONE_DEPTH)]
    runs += [
        Run(quality, preset) for preset in presets for quality in qualities_of(preset, QUALITIES)
    ]
    if splats in sweep.sampled:
        runs += [
            Run(quality, preset, samples=samples)
            for preset in presets
            for samples in sweep.samples.get(preset, ())
            for quality in qualities_of(preset, ("paper", DEFAULT_QUALITY))
        ]
    if splats is None:
        runs += [Run(DEFAULT_QUALITY, presets[0], skip) for skip in SKIPS]
    return runs


def qualities_of(preset: str, qualities: Iterable[str]) -> list[str]:
    """Return the qualities that an engine is measured with; with planes there is but one."""
    from splatline.contract.variants import CONFIGS
    from splatline.host.encode.quality import DEFAULT_QUALITY

    return [DEFAULT_QUALITY] if CONFIGS[preset].plane else list(qualities)


def budgeted(sweep: Sweep, splats: float | None) -> list[tuple[str, str]]:
    """Return the qualities and presets that get an error budget for a size of splats."""
    from splatline.host.encode.quality import DEFAULT_QUALITY
    from splatline.sim.reference.error_budget import LADDERS

    if splats not in sweep.ladders:
        return []
    drawn = sweep.presets if splats is None else sweep.fewer_presets
    planes = [(DEFAULT_QUALITY, "plane")] if "plane" in drawn else []
    return [*((quality, "paper") for quality in LADDERS), *planes]


def _budget_steps(sweep: Sweep, splats: float | None) -> int:
    """Return the number of pictures in the error budgets for a size of splats."""
    from splatline.contract.variants import CONFIGS
    from splatline.sim.reference.error_budget import ladder

    return sum(len(ladder(quality, CONFIGS[name])) for quality, name in budgeted(sweep, splats))
