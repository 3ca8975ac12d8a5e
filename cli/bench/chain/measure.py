"""The measurements of ``splatline bench chain``: whole frames in the Verilog of chains."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from splatline.cli.bench.subjects import Pose, poses
from splatline.host.encode.partition_methods import DEFAULT_METHOD, METHODS

if TYPE_CHECKING:
    from splatline.contract.config import EngineConfig
    from splatline.contract.frame import Frame
    from splatline.sim.cosim.player.jobs import Outcome, Times

__all__ = ["FRAMES", "Plan", "measure"]

FRAMES = 2
"""Number of frames of a video."""

SPLATS = 2.5
"""Median diameter in pixels."""

FULL = 2.4
"""Magnification at which a built-in scene fills the image."""

FILLED = ", filled"
"""Suffix of the name of a scene that fills the image."""


@dataclass(frozen=True)
class Plan:
    """The frames and chains to measure; a frame has about ``elements`` elements."""

    scenes: tuple[str, ...]
    clouds: tuple[Path, ...]
    size: tuple[int, int]
    elements: int
    presets: tuple[EngineConfig, ...]
    links: tuple[str, ...]
    engines: tuple[int, ...]

    def cases(self) -> list[tuple[str, str, str, int]]:
        """Return scene, partition method, link and number of engines of each run of a preset.

        The first scene is partitioned by every method and drawn with every link, the others by the
        default method with link ``merge``. A single engine gets each scene in the order of the
        default method, and in the host's own order (``elements``).
        """
        names = self.names()
        found = []
        for link in self.links:
            for engines in self.engines:
                if engines == 1:
                    if link == self.links[0]:  # one engine has no link
                        ways = (DEFAULT_METHOD, "elements")
                        found += [(name, way, link, engines) for name in names for way in ways]
                    continue
                everything = METHODS if link == "merge" else (DEFAULT_METHOD,)
                found += [(names[0], way, link, engines) for way in everything]
                if link == "merge":
                    found += [(name, DEFAULT_METHOD, link, engines) for name in names[1:]]
        return found

    def names(self) -> list[str]:
        """Return the names of the scenes; the first scene is also drawn filling the image."""
        first, *others = [*self.scenes, *(path.stem for path in self.clouds)]
        return [first, first + FILLED, *others]

    def total(self) -> int:
        """Return the number of runs."""
        return len(self.presets) * len(self.cases())


def measure(plan: Plan, advance: Callable[[str], None]) -> Iterator[dict[str, Any]]:
    """Yield the counts of each run; ``advance`` is called with a description before each."""
    from splatline.sim.cosim.player.chains import build_chain

    frames = {
        (name, config.name): frame
        for number, pose in enumerate(poses(plan.scenes, plan.clouds, plan.size))
        for name, frame, config in _frames(pose, plan, near=number == 0)
    }
    for config in plan.presets:
        for name, method, link, engines in plan.cases():
            advance(f"{config.name}, {name}: {engines} engines, {link}, {method}")
            built = build_chain(config, engines, link)
            yield _row(name, frames[name, config.name], method, link, engines, built)


def _frames(pose: Pose, plan: Plan, *, near: bool) -> Iterator[tuple[str, Frame, EngineConfig]]:
    """Yield a cloud's frames for each preset; if ``near``, also those that fill the image."""
    for suffix, zoom in (("", 1.0), (FILLED, FULL))[: 1 + near]:
        view = dataclasses.replace(pose.view, focal=pose.view.focal * zoom)
        points = plan.elements
        for _ in range(3):
            # Only some of the points are visible, so the number of points is found by iteration.
            frame = _frame(pose, view, points, zoom, plan.presets[0])
            if abs(frame.counts["elements"] - plan.elements) <= plan.elements // 200:
                break
            points = round(points * plan.elements / frame.counts["elements"])
        for config in plan.presets:
            yield pose.name + suffix, _frame(pose, view, points, zoom, config), config


def _frame(pose: Pose, view: Any, points: int, zoom: float, config: EngineConfig) -> Frame:
    """Return a frame of a cloud that is resampled to a number of points."""
    from splatline.host.cloud.resample import resample
    from splatline.host.pipeline import make_frame

    cloud, radii = resample(pose.cloud, pose.radii, points)
    # Ratio of the new discs' diameter to the old one.
    spacing = min(1.0, (len(pose.cloud) / points) ** 0.5)
    scale = SPLATS / (pose.usual * zoom * spacing)
    return make_frame(cloud, view, radii=radii * scale, config=config)


def _row(
    name: str, frame: Frame, method: str, link: str, engines: int, built: Any
) -> dict[str, Any]:
    """Play a frame alone and as a video; return its counts, ready for JSON."""
    from splatline.sim.cosim.player.chains import ChainJob, play_chain

    def job(drawn: Frame, count: int, written: str = "first") -> ChainJob:
        return ChainJob.partitioned(
            *[drawn] * count, engines=engines, method=method, write_tables=written
        )

    # An empty frame comes first, so that the clearing after reset is not counted.
    nothing = dataclasses.replace(frame, codewords=frame.codewords[-1:])
    video = method == DEFAULT_METHOD and link == "merge"
    jobs = [job(nothing, 1), job(frame, FRAMES if video else 1)]
    jobs += [job(frame, FRAMES, "every")] * video
    expected = jobs[1].pictures()[0]
    outcomes = play_chain(jobs, link=link, built=built)[1:]
    wrong = sum(raster.mismatches(expected) for out in outcomes for raster in out.rasters)
    first = outcomes[0].times[0]
    beats = len(outcomes[0].beats) // len(outcomes[0].rasters)
    return {
        "scene": name,
        "preset": frame.config.name,
        "link": link,
        "method": method,
        "engines": engines,
        "elements": frame.counts["elements"],
        "codewords": len(frame.codewords),
        "beats": beats,
        "cycles": first.end_beat - min(first.opened) + 1,
        "fill_cycles": first.first_beat - min(first.opened),
        "drain_cycles": first.end_beat - max(first.closed),
        "video_cycles": _period(outcomes[0]) if video else None,
        "video_table_cycles": _period(outcomes[1]) if video else None,
        "table_writes": frame.config.register_base + 6,
        "idle_cycles": _idle(outcomes[0].times) if video else None,
        "idle_table_cycles": _idle(outcomes[1].times) if video else None,
        "mismatched_pixels": wrong,
    }


def _period(outcome: Outcome) -> int:
    """Return the cycles between the end beats of the last two frames of a video."""
    before, last = outcome.times[-2:]
    return last.end_beat - before.end_beat


def _idle(times: Sequence[Times]) -> float:
    """Return the cycles without a code word between two frames, the mean over the engines."""
    before, last = times[-2:]
    gaps = [opened - closed - 1 for closed, opened in zip(before.closed, last.opened, strict=True)]
    return round(sum(gaps) / len(gaps), 1)
