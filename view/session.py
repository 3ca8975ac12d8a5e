"""A person's look at a cloud: events in, pictures and answers out. There is no network in it."""

from __future__ import annotations

import dataclasses
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy

from .camera import Camera
from .choices import Choices
from .command_line import render_command, shell_text
from .draw import Drawing, draw
from .events import Event
from .hardware import picture_numbers
from .live_cloud import LiveCloud
from .pace import Pace, ladder
from .saved import SavedFile, saved_picture, saved_words
from .split import Exact, draw_exact, draw_paper
from .steering import Seen, steer
from .subject import Subject

__all__ = ["Output", "Picture", "Session", "Superseded", "Tell"]

QUIET = 0.15
"""Seconds after the last step of the camera before a picture is refined."""

NOTHING, COARSE, FULL, REFINED, COMPARED = range(5)
"""How fine the last picture is: coarse; of the full size; with all samples; with the reference."""

ANSWERED = ("save", "command")
"""Kinds of events that change no picture."""

Tell = Callable[[str, float | None], None]
"""Told what is being done, and the share of it that is done; 1 ends it."""


class Superseded(Exception):  # noqa: N818  (it is no error)
    """A picture is not needed any more, since something changed."""


@dataclass(frozen=True)
class Picture:
    """A picture to be shown.

    Parameters
    ----------
    frame
        Its number: 1, 2, ...; both pictures of a split have one number.
    rgba
        Shape (height, width, 4), uint8. It may be coarser than the size that was asked for.
    refined
        Whether it is of the full size and has all samples.
    second
        Whether it is the right picture of a split.
    """

    frame: int
    rgba: npt.NDArray[np.uint8]
    refined: bool
    second: bool = False


Output = dict[str, Any] | Picture | SavedFile
"""A message of the protocol, a picture, or a file."""


class Session:
    """Camera, choices and size of one view, and what is to be drawn next.

    Events are queued by one thread and applied by another, all of them before a picture is drawn:
    the latest wins. While the camera moves, pictures are as coarse as :class:`Pace` says. When it
    rests, one of the full size follows, then one with all samples of a pixel, and then the exact
    reference if the view is split so.

    Parameters
    ----------
    subject
        The cloud.
    choices
        How it is drawn at first.
    pace
        How coarse moving pictures are.
    clock
        Seconds.
    tell
        Told how far long work is.
    between
        Called now and then within long work; others may draw in it.
    """

    def __init__(
        self,
        subject: Subject,
        choices: Choices | None = None,
        *,
        pace: Callable[[list[float]], Pace] = Pace,
        clock: Callable[[], float] = time.perf_counter,
        tell: Tell = lambda text, share: None,
        between: Callable[[], None] = lambda: None,
    ) -> None:
        self.subject = subject
        self.choices = choices or Choices()
        self.size = (512, 512)
        self.live: LiveCloud | None = None
        self.closed = False
        self.tell = tell
        self.between = between
        self._clock = clock
        self._new_pace = pace
        self._pace = pace([1.0])
        self._events: deque[Event] = deque()
        self._colour = self.choices.colour  # of the cloud
        self._camera: Camera | None = None
        self._home: Camera | None = None
        self._moving = False
        self._moved_at = -QUIET
        self._level = NOTHING
        self._version = 0
        self._frame = 0
        self._told: dict[str, Any] | None = None
        self._seen: Seen | None = None
        self._exact: tuple[Any, Exact] | None = None  # with what it was drawn of

    # Whatever a server asks.

    def queue(self, event: Event) -> None:
        """Note an event; it is applied by the next :meth:`work`. Any thread may call this."""
        self._events.append(event)

    @property
    def waiting(self) -> int:
        """Number of events that are not applied yet."""
        return len(self._events)

    @property
    def needs_cloud(self) -> bool:
        """Whether the cloud must be read, at first or in other colours: see :meth:`take`."""
        return self.live is None or self.choices.colour != self._colour

    def take(self, live: LiveCloud, colour: ColourBy | None) -> None:
        """Take the cloud in some colours, unless others were asked for since."""
        if colour != self.choices.colour:
            return
        self.live, self._colour = live, colour
        if self._home is None:
            self._fit(live)
        self._change()

    def refuse(self, colour: ColourBy | None) -> None:
        """Keep the colours as they are, since the cloud has no such ones."""
        if colour == self.choices.colour:
            self.choices = dataclasses.replace(self.choices, colour=self._colour)
            self._told = None

    def due(self) -> float | None:
        """Return the seconds until there is something to do; None: only an event brings some."""
        if self._events or self._told is None:
            return 0.0
        if self.live is None or self._level >= self._last_level:
            return None
        if self._level == NOTHING:
            return 0.0
        if self._moving:
            return None
        return max(self._moved_at + QUIET - self._clock(), 0.0)

    def work(self, *, may_draw: bool = True) -> list[Output]:
        """Apply all events; draw the next picture, if one is due and may be drawn."""
        outputs: list[Output] = []
        while self._events:
            try:
                outputs += self._apply(self._events.popleft())
            except InputError as error:
                outputs.append(_trouble(error))
            except Superseded:
                pass
        outputs += self._tell_settings()
        if may_draw and self.live is not None:
            try:
                outputs += self._next_picture(self.live)
            except Superseded:
                pass
            except InputError as error:
                self._level = COMPARED
                outputs.append(_trouble(error))
        return outputs

    @property
    def camera(self) -> Camera | None:
        """The camera as it is drawn, rounded; None before the cloud is read."""
        return None if self._camera is None else self._camera.rounded()

    def command(self) -> list[str]:
        """Return the arguments of ``splatline`` that make the refined picture.

        Raises
        ------
        InputError
            If the cloud is not read yet.
        """
        if self.camera is None:
            raise InputError("the cloud is not read yet")
        choices = self.choices
        words = render_command(self.subject, self._colour, self.camera, self.size, choices.settings)
        depth = ["--depth", f"{self.subject.name}-depth.png"]
        return [*words, *depth] if choices.show == "depth" else words

    # Events.

    def _apply(self, event: Event) -> list[Output]:
        """Apply an event; return its answers."""
        values = event.values
        if event.kind == "set":
            self._set(values["name"], values["value"])
        elif event.kind == "resize":
            self._resize((values["width"], values["height"]))
        elif event.kind == "moving":
            self._moving = values["value"]
        elif event.kind == "command":
            return [{"type": "command", "text": shell_text(self.command())}]
        elif event.kind == "save":
            return [self._save(values["what"])]
        elif self._camera is not None and self._home is not None:
            camera = steer(event, self._camera, self._home, self.size, self._seen)
            if camera != self._camera:
                self._camera, self._moved_at = camera, self._clock()
                self._change()
        return []

    def _set(self, name: str, value: Any) -> None:
        """Make a choice; other colours are shown when the cloud is read in them."""
        self.choices = self.choices.changed(name, value)
        if name in ("preset", "quality"):
            self._start_pace()
        if name != "colour":
            self._change()

    def _resize(self, size: tuple[int, int]) -> None:
        """Change the size; a camera that never moved sees the whole cloud again."""
        if size == self.size:
            return
        unmoved = self._camera == self._home
        self.size = size
        if self.live is not None:
            if unmoved:
                self._camera = None
            self._fit(self.live)
            self._change()

    def _fit(self, live: LiveCloud) -> None:
        """Fit the first camera to the size, and take it if there is none."""
        self._home = self.subject.home(live, self.size)
        self._camera = self._camera or self._home
        self._start_pace()

    def _start_pace(self) -> None:
        """Measure anew how long pictures take."""
        preset = self.choices.settings.preset
        self._pace = self._new_pace(ladder(self.size, (preset.max_width, preset.max_height)))

    def _change(self) -> None:
        """Note that what is shown is not up to date."""
        self._version += 1
        self._level = NOTHING

    def _tell_settings(self) -> list[Output]:
        """Return the settings, if they changed."""
        values = self.choices.described()
        if values == self._told:
            return []
        self._told = values
        camera = self.camera and {
            **dataclasses.asdict(self.camera),
            "target": list(self.camera.target),
        }
        return [{"type": "settings", **values, "camera": camera}]

    # Pictures.

    @property
    def _last_level(self) -> int:
        """The level after which there is nothing to draw."""
        return COMPARED if "reference" in (self.choices.split or ()) else REFINED

    def _next_picture(self, live: LiveCloud) -> list[Output]:
        """Draw the next picture that is due."""
        self._index(live)
        resting = not self._moving and self._clock() >= self._moved_at + QUIET
        if self._level == NOTHING:
            return self._draw_quickly(live, resting)
        if not resting or self._level >= self._last_level:
            return []
        return self._refine(live) if self._level < REFINED else self._compare(live)

    def _index(self, live: LiveCloud) -> None:
        """Build the index for the engine; tell if it takes long."""
        preset = self.choices.settings.preset
        if not live.has_index(preset):
            self.tell(f"Indexing {len(live.cloud):,} points", None)
            live.index(preset)
            self.tell("", 1.0)

    def _draw_quickly(self, live: LiveCloud, resting: bool) -> list[Output]:
        """Draw a picture of one sample a pixel, as coarse as it must be to be in time."""
        divisor = self._pace.divisor
        width, height = (max(round(side / divisor), 1) for side in self.size)
        start = self._clock()
        drawing = self._drawing(live, (width, height), 1)
        rgba = self._rgba(drawing)
        if not resting:
            self._pace.took(self._clock() - start)
        self._level = FULL if divisor == 1.0 else COARSE
        return [self._picture(rgba)]

    def _refine(self, live: LiveCloud) -> list[Output]:
        """Draw a picture of the full size; the last one has all samples, and its numbers."""
        samples = self.choices.settings.samples if self._level == FULL else 1
        if self._level == FULL and samples == 1 and self._seen is not None:
            drawing = self._seen[0]
        else:
            start = self._clock()
            drawing = self._drawing(live, self.size, samples, self._check)
            if samples == 1:
                self._pace.took_full(self._clock() - start)
        if samples != self.choices.settings.samples:
            self._level = FULL
            return [self._picture(self._rgba(drawing))]
        outputs = self._pictures(live, drawing)
        self._level = REFINED
        return [*outputs, *self._numbers(drawing, None)]

    def _compare(self, live: LiveCloud) -> list[Output]:
        """Draw the exact reference, and split the picture."""
        assert self._seen is not None
        drawing, camera = self._seen
        settings = self.choices.settings
        drawn_of = live, camera, self.size, settings.lights, settings.background
        if self._exact is None or self._exact[0] != drawn_of:
            version = self._version

            def progress(share: float) -> None:
                self.tell("Drawing the exact reference", min(share, 0.99))
                self.between()
                self._check(version)

            try:
                exact = draw_exact(live, camera, self.size, settings, progress)
            finally:
                self.tell("", 1.0)
            self._exact = drawn_of, exact
        outputs = self._pictures(live, drawing, self._exact[1])
        self._level = COMPARED
        return [*outputs, *self._numbers(drawing, self._exact[1])]

    def _pictures(
        self, live: LiveCloud, drawing: Drawing, exact: Exact | None = None
    ) -> list[Output]:
        """Return a refined picture, or both sides if the view is split and both are there."""
        split = self.choices.split
        if split is None or ("reference" in split and exact is None):
            return [self._picture(self._rgba(drawing), refined=True)]
        sides = [self._side(side, live, drawing, exact) for side in split]
        left = self._picture(sides[0], refined=True)
        return [left, dataclasses.replace(left, rgba=sides[1], second=True)]

    def _side(
        self, side: str, live: LiveCloud, drawing: Drawing, exact: Exact | None
    ) -> npt.NDArray[np.uint8]:
        """Return the pixels of one side of a split."""
        if side == "engine":
            return self._rgba(drawing)
        if side == "reference":
            assert exact is not None
            near, far = drawing.counts["depth_range"]
            return exact.rgba if self.choices.show == "picture" else exact.depth_rgba((near, far))
        assert self.camera is not None
        settings = self.choices.settings
        return self._rgba(draw_paper(live, self.camera, self.size, settings, self._check))

    def _drawing(
        self,
        live: LiveCloud,
        size: tuple[int, int],
        samples: int,
        check: Callable[[], None] = lambda: None,
    ) -> Drawing:
        """Draw with the camera and the choices as they are."""
        camera = self.camera
        assert camera is not None
        settings = dataclasses.replace(self.choices.settings, samples=samples)
        drawing = draw(live, camera, size, settings, check=check)
        self._seen = drawing, camera
        return drawing

    def _check(self, version: int | None = None) -> None:
        """Raise ``Superseded`` if another picture is asked for, or none."""
        changed = version is not None and version != self._version
        if changed or self.closed:
            raise Superseded
        if any(event.kind not in ANSWERED for event in tuple(self._events)):
            raise Superseded

    def _rgba(self, drawing: Drawing) -> npt.NDArray[np.uint8]:
        """Return the pixels that are shown of a drawing."""
        return drawing.rgba if self.choices.show == "picture" else drawing.depth_rgba

    def _picture(self, rgba: npt.NDArray[np.uint8], *, refined: bool = False) -> Picture:
        """Return a picture with the next number."""
        self._frame += 1
        return Picture(self._frame, rgba, refined)

    def _numbers(self, drawing: Drawing, exact: Exact | None) -> list[Output]:
        """Return the numbers of a refined picture, and the settings with the camera."""
        numbers = {
            "type": "numbers",
            "frame": self._frame,
            **picture_numbers(drawing),
            "psnr": None if exact is None else exact.psnr(drawing),
        }
        self._told = None
        return [numbers, *self._tell_settings()]

    def _save(self, what: str) -> SavedFile:
        """Return the refined picture, or its code words, as a file."""
        if self.live is None:
            raise InputError("the cloud is not read yet")
        if self._level >= REFINED and self._seen is not None:
            drawing = self._seen[0]
        else:
            drawing = self._drawing(self.live, self.size, self.choices.settings.samples)
            self._level = NOTHING
        name = self.subject.name
        if what == "words":
            return saved_words(drawing, name)
        return saved_picture(drawing, name, self.choices.show)


def _trouble(error: InputError) -> dict[str, Any]:
    """Return an error as a message of one line."""
    return {"type": "error", "text": " ".join(str(error).split())}
