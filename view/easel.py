"""Draws what a session looks at: coarsely and at once, then finer and finer."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig

from .camera import Camera
from .choices import Choices
from .draw import Drawing, draw
from .hardware import picture_numbers
from .live_cloud import LiveCloud
from .outputs import Output, Picture, Tell
from .pace import Pace, ladder
from .split import Exact, draw_exact, draw_paper
from .steering import Seen

__all__ = ["Easel", "Sight"]

NOTHING, COARSE, FULL, REFINED, COUNTED, COMPARED = range(6)
"""How far a sight is drawn: coarse; in full size; with all samples; its numbers counted; with the
exact reference."""


@dataclass(frozen=True)
class Sight:
    """A sight to draw: a cloud, a camera, the choices, and width and height in pixels."""

    live: LiveCloud
    camera: Camera
    choices: Choices
    size: tuple[int, int]


class Easel:
    """Draws pictures of a sight, each finer than the one before, until it changes.

    Parameters
    ----------
    new_pace
        Makes what chooses the size of moving pictures, from divisors.
    clock
        Seconds.
    check
        Called within long work; raises ``Superseded`` if that is not needed any more.
    tell, between
        Called within long work; see :class:`Session`.
    """

    def __init__(
        self,
        new_pace: Callable[[list[float]], Pace] = Pace,
        clock: Callable[[], float] = time.perf_counter,
        check: Callable[[], None] = lambda: None,
        tell: Tell = lambda text, share: None,
        between: Callable[[], None] = lambda: None,
    ) -> None:
        self.seen: Seen | None = None
        self.tell = tell
        self.between = between
        self._new_pace = new_pace
        self._pace = new_pace([1.0])
        self._clock = clock
        self._check = check
        self._level = NOTHING
        self._frame = 0
        self._numbers: dict[str, Any] = {}
        self._exact: tuple[Any, Exact] | None = None  # with what it was drawn of

    def change(self) -> None:
        """Note that the sight changed."""
        self._level = NOTHING

    def give_up(self) -> None:
        """Draw nothing until the sight changes."""
        self._level = COMPARED

    def start_pace(self, size: tuple[int, int], preset: EngineConfig) -> None:
        """Measure anew how long pictures take, of a size and by an engine."""
        self._pace = self._new_pace(ladder(size, (preset.max_width, preset.max_height)))

    @property
    def is_blank(self) -> bool:
        """Whether nothing of the sight is drawn yet."""
        return self._level == NOTHING

    def is_done(self, choices: Choices) -> bool:
        """Whether there is no finer picture to draw."""
        last = COMPARED if "reference" in (choices.split or ()) else COUNTED
        return self._level >= last

    def draw(self, sight: Sight, *, resting: bool) -> list[Output]:
        """Return the next picture that is due, or the numbers of the last one.

        Raises
        ------
        Superseded
            If it is not needed any more.
        InputError
            If it cannot be drawn.
        """
        self._index(sight)
        if self._level == NOTHING:
            return self._draw_quickly(sight, resting)
        if not resting or self.is_done(sight.choices):
            return []
        if self._level < REFINED:
            return self._refine(sight)
        return self._count() if self._level == REFINED else self._compare(sight)

    def drawing(self, sight: Sight) -> Drawing:
        """Return the refined drawing."""
        if self._level >= REFINED and self.seen is not None:
            return self.seen[0]
        drawing = self._drawing(sight, sight.size, sight.choices.settings.samples)
        self._level = NOTHING  # it was not shown
        return drawing

    def _index(self, sight: Sight) -> None:
        """Build the index for the engine; tell if it takes long."""
        live, wanted = sight.live, (sight.choices.settings.preset, sight.camera.upward)
        if not live.has_index(*wanted):
            self.tell(f"Indexing {len(live.cloud):,} points", None)
            live.index(*wanted)
            self.tell("", 1.0)

    def _draw_quickly(self, sight: Sight, resting: bool) -> list[Output]:
        """Draw a picture of one sample a pixel, as coarse as it must be to be in time.

        It has its specks: to close them takes most of a frame's time again.
        """
        divisor = self._pace.divisor
        width, height = (max(round(side / divisor), 1) for side in sight.size)
        start = self._clock()
        drawing = self._drawing(sight, (width, height), 1, close=False)
        picture = self._picture(drawing, sight.choices)
        if not resting:
            self._pace.took(self._clock() - start)
        self._level = FULL if divisor == 1.0 else COARSE
        return [picture]

    def _refine(self, sight: Sight) -> list[Output]:
        """Draw a picture of the full size; the last one has all samples."""
        wanted = sight.choices.settings.samples
        samples = wanted if self._level == FULL else 1
        is_same = self._level == FULL and samples == 1 and not sight.choices.settings.close_specks
        if is_same and self.seen is not None:
            drawing = self.seen[0]
        else:
            start = self._clock()
            drawing = self._drawing(sight, sight.size, samples, self._pause)
            if samples == 1:
                closing = drawing.counts["seconds"].get("close", 0.0)
                self._pace.took_full(self._clock() - start - closing)
        if samples != wanted:
            self._level = FULL
            return [self._picture(drawing, sight.choices)]
        outputs = self._pictures(sight, drawing, None)
        self._level = REFINED
        return outputs

    def _count(self) -> list[Output]:
        """Count what the picture takes in hardware."""
        assert self.seen is not None
        self._numbers = picture_numbers(self.seen[0], self._pause)
        self._level = COUNTED
        return [self._told_numbers(None)]

    def _told_numbers(self, psnr: float | None) -> Output:
        """Return the numbers as a message about the last picture."""
        return {"type": "numbers", "frame": self._frame, **self._numbers, "psnr": psnr}

    def _compare(self, sight: Sight) -> list[Output]:
        """Draw the exact reference, unless it is drawn, and split the picture."""
        assert self.seen is not None
        settings, size = sight.choices.settings, sight.size
        look = settings.lights, settings.background, settings.close_specks
        drawn_of = sight.live, sight.camera, size, look
        if self._exact is None or self._exact[0] != drawn_of:

            def progress(share: float) -> None:
                self.tell("Drawing the exact reference", min(share, 0.99))
                self._pause()

            try:
                exact = draw_exact(sight.live, sight.camera, size, settings, progress)
            finally:
                self.tell("", 1.0)
            self._exact = drawn_of, exact
        drawing, exact = self.seen[0], self._exact[1]
        outputs = self._pictures(sight, drawing, exact)
        self._level = COMPARED
        return [*outputs, self._told_numbers(exact.psnr(drawing))]

    def _pictures(self, sight: Sight, drawing: Drawing, exact: Exact | None) -> list[Output]:
        """Return a refined picture, or both sides of a split if they are there."""
        split = sight.choices.split
        if split is None or ("reference" in split and exact is None):
            return [self._picture(drawing, sight.choices, refined=True)]
        first, second = (self._side(side, sight, drawing, exact) for side in split)
        self._frame += 1
        left = Picture(self._frame, first, refined=True)
        return [left, dataclasses.replace(left, rgba=second, second=True)]

    def _side(
        self, side: str, sight: Sight, drawing: Drawing, exact: Exact | None
    ) -> npt.NDArray[np.uint8]:
        """Return the pixels of one side of a split."""
        choices = sight.choices
        if side == "engine":
            return _pixels(drawing, choices)
        if side == "reference":
            assert exact is not None
            near, far = drawing.counts["depth_range"]
            return exact.rgba if choices.show == "picture" else exact.depth_rgba((near, far))
        paper = draw_paper(sight.live, sight.camera, sight.size, choices.settings, self._pause)
        return _pixels(paper, choices)

    def _drawing(
        self,
        sight: Sight,
        size: tuple[int, int],
        samples: int,
        check: Callable[[], None] = lambda: None,
        *,
        close: bool = True,
    ) -> Drawing:
        """Draw a sight in a size, with some samples a pixel; close its specks if they are to be."""
        chosen = sight.choices.settings
        settings = dataclasses.replace(
            chosen, samples=samples, close_specks=close and chosen.close_specks
        )
        drawing = draw(sight.live, sight.camera, size, settings, check=check)
        self.seen = drawing, sight.camera
        return drawing

    def _pause(self) -> None:
        """Let others draw; then end if the work is not needed any more."""
        self.between()
        self._check()

    def _picture(self, drawing: Drawing, choices: Choices, *, refined: bool = False) -> Picture:
        """Return a drawing as a picture with the next number."""
        self._frame += 1
        return Picture(self._frame, _pixels(drawing, choices), refined)


def _pixels(drawing: Drawing, choices: Choices) -> npt.NDArray[np.uint8]:
    """Return the pixels that are shown of a drawing."""
    return drawing.rgba if choices.show == "picture" else drawing.depth_rgba
