"""The measurements of ``splatline bench engine``: cycles of frames, and the bound of each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from splatline.cli.bench.subjects import Pose, poses

if TYPE_CHECKING:
    from splatline.contract.config import EngineConfig
    from splatline.contract.frame import Frame
    from splatline.contract.raster import Raster

__all__ = ["CLOCK_HZ", "Plan", "count_luts", "measure"]

CLOCK_HZ = 100e6
"""The paper's clock rate, for rates in elements a second."""


@dataclass(frozen=True)
class Plan:
    """The frames to measure: all combinations of these values."""

    scenes: tuple[str, ...]
    clouds: tuple[Path, ...]
    size: tuple[int, int]
    splats: tuple[float | None, ...]
    presets: tuple[EngineConfig, ...]
    qualities: tuple[str, ...]

    def total(self) -> int:
        """Return the number of frames."""
        frames = sum(len(self.qualities_of(config)) for config in self.presets)
        return (len(self.scenes) + len(self.clouds)) * len(self.splats) * frames

    def qualities_of(self, config: EngineConfig) -> tuple[str, ...]:
        """Return the qualities of an engine's frames; with planes there is one, ``exact``."""
        return ("exact",) if config.plane else self.qualities


def count_luts(presets: Sequence[EngineConfig], advance: Callable[[str], None]) -> dict[str, int]:
    """Return the number of LUTs of each preset, by name."""
    from splatline.flow.area.synth import count_engine

    counts = {}
    for config in presets:
        advance(f"{config.name}: Yosys")
        counts[config.name] = count_engine(config)["lut4"]
    return counts


def measure(
    plan: Plan, luts: dict[str, int], advance: Callable[[str], None]
) -> Iterator[dict[str, Any]]:
    """Yield the counts of each frame; ``advance`` is called with a description before each."""
    from splatline.host.pipeline import make_frame
    from splatline.host.shading.materials import find_materials
    from splatline.host.visibility.block_index import build_index

    for pose in poses(plan.scenes, plan.clouds, plan.size):
        for splats in plan.splats:
            radii = pose.scaled(splats)
            for config in plan.presets:
                materials = find_materials(pose.cloud, 1 << config.material_bits)
                index = build_index(pose.cloud, radii, materials)
                for quality in plan.qualities_of(config):
                    advance(f"{pose.name}, {splats or 'auto'}: {quality} {config.name}")
                    frame = make_frame(index, pose.view, quality=quality, config=config)
                    yield _row(pose, splats, quality, frame, luts.get(config.name))


def _row(
    pose: Pose, splats: float | None, quality: str, frame: Frame, lut4: int | None
) -> dict[str, Any]:
    """Return the counts of a frame, ready for JSON; those of LUTs are None if not counted."""
    from splatline.sim import golden
    from splatline.sim.cycles.bound import bound_cycles
    from splatline.sim.cycles.cycles import count_cycles

    elements, codewords = frame.counts["elements"], len(frame.codewords)
    cycles = count_cycles(frame)
    raster_words = _words_drawn(golden.render(frame))
    bound = bound_cycles(frame)
    rate = CLOCK_HZ * elements / cycles
    return {
        "scene": pose.name,
        "quality": quality,
        "preset": frame.config.name,
        "splats": splats or "auto",
        "median_pixels": round(splats or pose.usual, 3),
        "elements": elements,
        "codewords": codewords,
        "cycles": cycles,
        "cycles_per_element": round(cycles / elements, 4),
        "cycles_per_codeword": round(cycles / codewords, 4),
        "bound_cycles": bound,
        "ratio": round(cycles / bound, 4),
        "raster_words": raster_words,
        "elements_per_second": round(rate),
        "lut4": lut4,
        "elements_per_second_per_lut": None if lut4 is None else round(rate / lut4),
    }


def _words_drawn(raster: Raster) -> int:
    """Return the number of raster words with at least one drawn pixel."""
    import numpy as np

    height, width = raster.drawn.shape
    pixels = raster.config.raster_pixels
    padded = np.pad(raster.drawn, ((0, 0), (0, -width % pixels)))
    return int(padded.reshape(height, -1, pixels).any(axis=2).sum())
