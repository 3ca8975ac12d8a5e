"""Draws a large cloud part by part: frames of each part, joined to those of the whole.

What is joined has at most one code word for each pixel, whatever the cloud's size. Frames may be
joined in any order and in any groups (:mod:`splatline.host.encode.join_frames`).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.contract.presets import DEFAULT
from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.spacing import Discs, measure_discs
from splatline.host.cloud.upward import turn_upward
from splatline.host.encode.close_specks import close_specks
from splatline.host.encode.join_frames import join_frames
from splatline.host.encode.quality import DEFAULT_QUALITY
from splatline.host.picture_tiles.frames import tile_picture
from splatline.host.pipeline import make_frames
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import materials_of
from splatline.host.visibility.skips import DEFAULT_SKIPS

from .plan import Part, Plan
from .read_part import read_part

__all__ = [
    "Drawing",
    "PartFrames",
    "check_shown",
    "draw_part",
    "draw_parts",
    "frames_of",
    "join_frames_of",
    "join_parts",
]

OVERDRAWN = "overdrawn"
"""Of points of one pixel the nearest alone is sent. Which that is depends on a part's other points,
and joining leaves out the others anyway."""

Progress = Callable[[str, float], None]


@dataclasses.dataclass(frozen=True)
class Drawing:
    """Settings of the drawing of parts; see ``make_frames``.

    Parameters
    ----------
    config
        The engine's configuration.
    quality
        How splats become code words.
    skips
        Reasons to leave points out.
    samples
        Samples a pixel.
    lighting
        The lights.
    splat_size
        Diameter of all discs, in the cloud's unit. None: the discs close the surface.
    memory
        Bytes that may be used for a part.
    up
        The axis along which a survey's estimated normals point; None: they have no sign. See
        ``turn_upward``.
    close_specks
        Whether specks are closed, when all parts are joined.
    """

    config: EngineConfig = DEFAULT
    quality: str = DEFAULT_QUALITY
    skips: frozenset[str] = DEFAULT_SKIPS
    samples: int = 1
    lighting: Lighting = dataclasses.field(default_factory=Lighting)
    splat_size: float | None = None
    memory: int = 2 << 30
    up: str | None = None
    close_specks: bool = False

    def in_tiles(self, plan: Plan) -> bool:
        """Return whether a plan's picture is larger than the engine's image."""
        width, height = plan.view.width, plan.view.height
        return width > self.config.max_width or height > self.config.max_height


@dataclasses.dataclass(frozen=True)
class PartFrames:
    """The frames of a part, or of several parts together.

    Parameters
    ----------
    frames
        One for each sample; of a picture in tiles for each tile and sample, row by row, each from
        left to right, None where nothing is. Empty if the parts show nothing.
    points
        Points that were read.
    dropped, culled
        Points left out, by reason: when they were read, and when they were drawn.
    elements
        Points drawn.
    notes
        What a person should know, each in one line.
    used, ignored
        Columns of the files that were used, as what, and those that were not.
    """

    frames: tuple[Frame | None, ...]
    points: int = 0
    dropped: dict[str, int] = dataclasses.field(default_factory=dict)
    culled: dict[str, int] = dataclasses.field(default_factory=dict)
    elements: int = 0
    notes: tuple[str, ...] = ()
    used: dict[str, str] = dataclasses.field(default_factory=dict)
    ignored: tuple[str, ...] = ()


def draw_part(
    plan: Plan, part: Part, drawing: Drawing, *, progress: Progress | None = None
) -> PartFrames:
    """Return the frames of a part; they have no word that no pixel shows.

    ``progress`` is called now and then with a stage, ``read``, ``normals``, ``spacing`` or
    ``encode``, and the share of it that is done.

    Raises
    ------
    InputError
        If the file is damaged.
    """

    def told(stage: str) -> Callable[[float], None] | None:
        return None if progress is None else lambda share: progress(stage, share)

    cloud, dropped = read_part(plan, part, drawing.memory, progress=progress)
    if cloud is None:
        return PartFrames((), points=sum(dropped.values()), dropped=dropped)
    discs = measure_discs(cloud, drawing.splat_size, progress=told("spacing"))
    cloud = turn_upward(cloud, drawing.up)
    frames, counts = _frames(plan, drawing, cloud, discs, told("encode"))
    return PartFrames(
        frames=tuple(None if frame is None else join_frames([frame]) for frame in frames),
        points=len(cloud) + sum(dropped.values()),
        dropped=dict(dropped),
        culled=_total(count["culled"] for count in counts),
        elements=sum(count["elements"] for count in counts),
        notes=cloud.notes,
        used=cloud.used,
        ignored=cloud.ignored,
    )


def _frames(
    plan: Plan,
    drawing: Drawing,
    cloud: Cloud,
    discs: Discs,
    progress: Callable[[float], None] | None,
) -> tuple[list[Frame | None], list[dict[str, Any]]]:
    """Return the frames of a part, and counts whose sum is the part's."""
    options: dict[str, Any] = {
        **discs.drawn(close_specks=drawing.close_specks)._asdict(),
        "materials": materials_of(cloud, plan.palette),
        "lighting": drawing.lighting,
        "config": drawing.config,
        "quality": drawing.quality,
        "skips": drawing.skips - {OVERDRAWN},
        "depth_range": plan.depth_range,
        "may_be_empty": True,
    }
    if drawing.in_tiles(plan):
        picture = tile_picture(cloud, plan.view, drawing.samples, **options)
        rows = list(picture.rows())
        frames = [frame for row in rows for tile in row for frame in tile.frames]
        return frames, [picture.counts]
    made = make_frames(cloud, plan.view, drawing.samples, **options, progress=progress)
    return list(made), [frame.counts for frame in made]


def join_parts(parts: Sequence[PartFrames]) -> PartFrames:
    """Return the frames of several parts together; at least one is given."""
    first = parts[0]
    return PartFrames(
        frames=join_frames_of([part.frames for part in parts]),
        points=sum(part.points for part in parts),
        dropped=_total(part.dropped for part in parts),
        culled=_total(part.culled for part in parts),
        elements=sum(part.elements for part in parts),
        notes=tuple(dict.fromkeys(note for part in parts for note in part.notes)),
        used=next((part.used for part in parts if part.used), first.used),
        ignored=next((part.ignored for part in parts if part.used), first.ignored),
    )


def join_frames_of(parts: Sequence[tuple[Frame | None, ...]]) -> tuple[Frame | None, ...]:
    """Return the frames of several parts together; a part without frames shows nothing."""
    drawn = [frames for frames in parts if frames]
    return tuple(_joined(frames) for frames in zip(*drawn, strict=True))


def _joined(frames: Sequence[Frame | None]) -> Frame | None:
    """Return several parts' frames of a tile as one, or None if all are empty."""
    some = [frame for frame in frames if frame is not None]
    return join_frames(some) if some else None


def draw_parts(plan: Plan, drawing: Drawing, *, progress: Progress | None = None) -> PartFrames:
    """Draw all parts, one after the other; the memory holds one of them.

    ``progress`` is called now and then with the stage ``parts`` and the share that is done.

    Raises
    ------
    InputError
        If a file is damaged, or nothing is in view.
    """
    joined = PartFrames(())
    for number, part in enumerate(plan.parts):
        drawn = draw_part(plan, part, drawing, progress=_within(progress, number, len(plan.parts)))
        joined = join_parts([joined, drawn])
    check_shown(plan, drawing, joined)
    return joined


def check_shown(plan: Plan, drawing: Drawing, joined: PartFrames) -> None:
    """Raise ``InputError`` if nothing is in view."""
    if not joined.elements:
        culled = {reason: count // drawing.samples for reason, count in joined.culled.items()}
        left_out = _total([joined.dropped, culled])
        reasons = ", ".join(f"{count:,} {reason}" for reason, count in left_out.items() if count)
        raise InputError(
            f"nothing of {plan.files[0].path.name} is in view: of {joined.points:,} points,"
            f" {reasons}; change the view"
        )


def frames_of(plan: Plan, drawing: Drawing, joined: PartFrames) -> list[Frame]:
    """Return the frames of a picture, one for each sample.

    They have the counts of :func:`splatline.host.pipeline.make_frames`.
    """
    found = []
    for number, frame in enumerate(joined.frames):
        assert frame is not None, "a picture in tiles has no frame of its own"
        own = close_specks(frame) if drawing.close_specks else frame
        sums: dict[str, Any] = {"culled": joined.culled, "elements": joined.elements}
        if number:  # those of the first stand for all samples
            sums = {"culled": dict.fromkeys(joined.culled, 0), "elements": 0}
        counts = {
            "points": joined.points,
            "dropped": joined.dropped,
            **sums,
            "quality": drawing.quality,
            "skips": sorted(drawing.skips - {OVERDRAWN}),
            "shapes": "table",
            **({"specks": own.counts["specks"]} if drawing.close_specks else {}),
            "bits_sent": {"table": drawing.config.codeword_bits * len(own.codewords)},
            "codewords": len(own.codewords),
            "control_words": own.counts["control_words"],
            "depth_range": list(plan.depth_range),
            "seconds": {},
        }
        found.append(dataclasses.replace(own, counts=counts))
    return found


def _total(counts: Any) -> dict[str, int]:
    """Return the sums of counts by name."""
    total: dict[str, int] = {}
    for each in counts:
        for name, number in each.items():
            total[name] = total.get(name, 0) + number
    return total


def _within(progress: Progress | None, number: int, parts: int) -> Progress | None:
    """Return what tells the share of all parts; reading is nearly all of the work."""
    if progress is None:
        return None
    shares = {"read": (0.0, 0.8), "normals": (0.8, 0.1), "spacing": (0.9, 0.05)}

    def tell(stage: str, share: float) -> None:
        first, length = shares.get(stage, (0.95, 0.05))
        progress("parts", (number + first + length * share) / parts)

    return tell
