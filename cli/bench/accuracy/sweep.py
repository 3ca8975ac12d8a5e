"""The pictures of ``splatline bench accuracy``: every combination that is measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

__all__ = [
    "FLOAT",
    "FLOAT_DEPTHS",
    "FLOAT_ONE_DEPTH",
    "SAMPLED",
    "TWICE",
    "Run",
    "Size",
    "Sweep",
    "budgeted",
    "plan",
    "plane_presets",
    "qualities_of",
    "way",
]

FLOAT = "float"
FLOAT_ONE_DEPTH = "float, one depth a splat"
FLOAT_DEPTHS = "float, 12-bit depth a pixel"
"""Qualities without an engine: exact samples; the same with one depth a splat; and with the depth
bits, colour and shading of ``plane``, but the disc's own depth at every pixel."""

TWICE = "twice"
"""Splats twice as large as the points' spacing."""

Size: TypeAlias = float | str | None
"""A size of splats: the median diameter in pixels, ``TWICE``, or None: the points' spacing."""

SAMPLED = (1, 4, 16)
"""Numbers of samples a pixel with which engines with planes are compared to float."""


def plane_presets() -> tuple[str, ...]:
    """Return the names of the engines with planes, but for the variants."""
    from splatline.contract.variants import CONFIGS, PLANE_VARIANTS

    return tuple(
        name for name, config in CONFIGS.items() if config.plane and config not in PLANE_VARIANTS
    )


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
        Sizes of the splats.
    presets
        Engines for splats of the points' spacing.
    fewer_presets
        Engines for splats of other sizes.
    ladders
        Sizes of splats that get an error budget.
    sampled
        Sizes of splats that are also drawn with several samples a pixel; ``TWICE`` always is.
    samples
        Numbers of samples a pixel, by preset; for engines with planes and for float ``SAMPLED``.
    repeats
        Calls of host and golden renderer; the fastest one counts.
    """

    paths: tuple[Path, ...]
    scenes: tuple[str, ...]
    views: tuple[tuple[float, float], ...]
    size: tuple[int, int] = (512, 512)
    splats: tuple[Size, ...] = (None, TWICE, 1.5, 3.5, 7.0, 14.0)
    presets: tuple[str, ...] = field(
        default_factory=lambda: ("paper", "rgb24", "depth12", *plane_presets())
    )
    fewer_presets: tuple[str, ...] = field(
        default_factory=lambda: ("paper", "rgb24", *plane_presets())
    )
    ladders: tuple[Size, ...] = (None, TWICE, 3.5, 7.0)
    sampled: tuple[Size, ...] = (None, 3.5, 7.0)
    samples: Mapping[str, tuple[int, ...]] = field(
        default_factory=lambda: dict.fromkeys(("paper", "rgb24"), SAMPLED[1:])
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


def plan(sweep: Sweep, splats: Size) -> list[Run]:
    """Return the pictures to draw for a size of splats."""
    from splatline.host.encode.quality import DEFAULT_QUALITY, QUALITIES
    from splatline.host.visibility.skips import SKIPS

    presets = sweep.presets if splats is None else sweep.fewer_presets
    runs = [Run(FLOAT), Run(FLOAT_ONE_DEPTH)]
    if splats in (None, TWICE):
        runs += [Run(FLOAT, samples=samples) for samples in SAMPLED[1:]]
        runs += [Run(FLOAT_DEPTHS, samples=samples) for samples in SAMPLED]
    if splats == TWICE:
        presets = tuple(name for name in presets if name == "rgb24" or name in plane_presets())
        return runs + [
            Run(DEFAULT_QUALITY, name, samples=samples) for name in presets for samples in SAMPLED
        ]
    runs += [
        Run(quality, preset) for preset in presets for quality in qualities_of(preset, QUALITIES)
    ]
    if splats in sweep.sampled:
        runs += [
            Run(quality, preset, samples=samples)
            for preset in presets
            for samples in _several(sweep, preset)
            for quality in qualities_of(preset, ("paper", DEFAULT_QUALITY))
        ]
    if splats is None:
        runs += [Run(DEFAULT_QUALITY, presets[0], skip) for skip in SKIPS]
    return runs


def _several(sweep: Sweep, preset: str) -> tuple[int, ...]:
    """Return the numbers of samples a pixel, over one, with which an engine is measured."""
    return SAMPLED[1:] if preset in plane_presets() else sweep.samples.get(preset, ())


def qualities_of(preset: str, qualities: Iterable[str]) -> list[str]:
    """Return the qualities that an engine is measured with; with planes there is but one."""
    from splatline.contract.variants import CONFIGS
    from splatline.host.encode.quality import DEFAULT_QUALITY

    return [DEFAULT_QUALITY] if CONFIGS[preset].plane else list(qualities)


def budgeted(sweep: Sweep, splats: Size) -> list[Run]:
    """Return the pictures that get an error budget for a size of splats.

    Those of ``plane`` have one sample a pixel and sixteen: with one, its own error is far below
    that of the sampling.
    """
    from splatline.host.encode.quality import DEFAULT_QUALITY
    from splatline.sim.reference.error_budget import LADDERS

    if splats not in sweep.ladders:
        return []
    drawn = sweep.presets if splats is None else sweep.fewer_presets
    runs = [] if splats == TWICE else [Run(quality, "paper") for quality in LADDERS]
    if "plane" in drawn:
        several = splats in (None, TWICE)
        runs += [
            Run(DEFAULT_QUALITY, "plane", samples=samples)
            for samples in ((1, SAMPLED[-1]) if several else (1,))
        ]
    return runs


def _budget_steps(sweep: Sweep, splats: Size) -> int:
    """Return the number of pictures in the error budgets for a size of splats."""
    from splatline.contract.variants import CONFIGS
    from splatline.sim.reference.error_budget import ladder

    return sum(
        len(ladder(run.quality, CONFIGS[run.preset]))
        for run in budgeted(sweep, splats)
        if run.preset
    )
