"""Cycles of almost empty frames: a few small splats at random positions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from splatline.contract.config import EngineConfig
    from splatline.contract.frame import Frame
    from splatline.host.cloud.cloud import Cloud

__all__ = ["COUNTS", "PIXELS", "few_splats", "measure_few"]

COUNTS = (1, 10, 100, 1000)
"""Numbers of splats in a frame."""

PIXELS = 3.0
"""Diameter of the splats in pixels."""

SEED = 7


def measure_few(presets: Sequence[EngineConfig], size: tuple[int, int]) -> Iterator[dict[str, Any]]:
    """Yield the counts of each frame on each preset, ready for JSON.

    The frame is not the engine's first one, which would wait for the clearing of the window.
    """
    import numpy as np

    from splatline.sim import golden
    from splatline.sim.cycles.cycles import count_cycles

    for config in presets:
        for count in COUNTS:
            frame = few_splats(count, size, config)
            words = np.add.reduceat(
                golden.render(frame).drawn, range(0, size[0], config.raster_pixels), axis=1
            )
            yield {
                "preset": config.name,
                "elements": frame.counts["elements"],
                "codewords": len(frame.codewords),
                "raster_words": int(np.count_nonzero(words)),
                "cycles": count_cycles(frame, after_reset=False),
            }


def few_splats(count: int, size: tuple[int, int], config: EngineConfig) -> Frame:
    """Return a frame of some splats at random positions of the image."""
    import numpy as np

    from splatline.host.pipeline import make_frame
    from splatline.host.visibility.view import View

    view = View(np.array([0.0, 0.0, -1.0]), np.eye(3), float(max(size)), *size, near=0.1)
    radii = np.full(count, 0.5 * PIXELS / max(size))
    return make_frame(_scatter(count, size), view, radii=radii, quality="fast", config=config)


def _scatter(count: int, size: tuple[int, int]) -> Cloud:
    """Return points at random positions of the plane z = 0, facing the eye."""
    import numpy as np

    from splatline.host.files.assemble import Columns, assemble_cloud

    rng = np.random.default_rng(SEED)
    half = 0.5 * (np.array(size) - 2.0 * PIXELS) / max(size)
    positions = np.concatenate([rng.uniform(-half, half, (count, 2)), np.zeros((count, 1))], axis=1)
    return assemble_cloud(Columns(positions, -np.eye(3)[[2] * count]), "few")
