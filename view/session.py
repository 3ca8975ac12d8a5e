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
from splatline.contract.presets import PRESETS
from splatline.host.files.colouring import check_map
from splatline.host.files.wanted import ColourBy
from splatline.host.pipeline import check_request

from .camera import Camera
from .command_line import hex_colour, render_command, shell_text
from .draw import Drawing, Settings, draw
from .events import DEFAULT_COLOUR, Event
from .hardware import picture_numbers
from .live_cloud import LiveCloud
from .pace import Pace
from .subject import Subject

__all__ = ["Output", "Picture", "SavedFile", "Session", "Superseded"]

QUIET = 0.15
"""Seconds after the last step of the camera before a picture is refined."""

NEAREST, FARTHEST = 1e-5, 1e3
"""Distances that the camera keeps to, over that of the first picture."""

ANSWERED = ("save", "command")
"""Kinds of events that change no picture."""


class Superseded(Exception):  # noqa: N818  (it is no error)
    """A picture is not needed any more, since the camera moved on."""


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
        Whether it is as fine as it gets, with all samples.
    second
        Whether it is the right picture of a split.
    """

    frame: int
    rgba: npt.NDArray[np.uint8]
    refined: bool
    second: bool = False


@dataclass(frozen=True)
class SavedFile:
    """A file for the person: its name, its type, and its bytes."""

    name: str
    mime: str
    data: bytes


Output = dict[str, Any] | Picture | SavedFile
"""A message of the protocol, a picture, or a file."""


class Session:
    """Camera, settings and size of one view, and what is to be drawn next.

    Events are queued by one thread and applied by another, all of them before a picture is drawn:
    the latest wins. While the camera moves, pictures are as coarse as :class:`Pace` says. When it
    rests, one of the full size follows, and then one with all samples of a pixel.

    Parameters
    ----------
    subject
        The cloud.
    settings
        How it is drawn at first.
    colour
        What colours its points at first; None: the file's own colours.
    clock
        Seconds.
    """

    def __init__(
        self,
        subject: Subject,
        settings: Settings | None = None,
        colour: ColourBy | None = None,
        *,
        pace: Pace | None = None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.subject = subject
        self.settings = settings or Settings()
        self.colour = colour
        self.size = (512, 512)
        self.show = "picture"
        self.split: tuple[str, str] | None = None
        self.pace = pace or Pace()
        self.live: LiveCloud | None = None
        self._shown_colour = colour
        self._clock = clock
        self._events: deque[Event] = deque()
        self._camera: Camera | None = None
        self._home: Camera | None = None
        self._moving = False
        self._moved_at = -QUIET
        self._level = 0  # 1: a coarse picture is shown, 2: one of full size, 3: a refined one
        self._frame = 0
        self._told: dict[str, Any] | None = None
        self._last: tuple[Drawing, Camera] | None = None

    # -- what the server asks -------------------------------------------------------------------

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
        return self.live is None or self.colour != self._shown_colour

    def take(self, live: LiveCloud, colour: ColourBy | None) -> None:
        """Take the cloud, in some colours; they are ignored if others were asked for since."""
        if colour != self.colour:
            return
        self.live, self._shown_colour, self._level = live, colour, 0
        if self._camera is None:
            self._go_home()

    def refuse(self, colour: ColourBy | None) -> None:
        """Keep the colours as they are, since the cloud has no such ones."""
        if colour == self.colour:
            self.colour = self._shown_colour

    def due(self) -> float | None:
        """Return the seconds until there is something to do; None: only an event brings some."""
        if self._events:
            return 0.0
        if self.live is None or self._level >= 3:
            return None
        if self._level == 0:
            return 0.0
        if self._moving:
            return None
        return max(self._moved_at + QUIET - self._clock(), 0.0)

    def work(self, *, may_draw: bool = True) -> list[Output]:
        """Apply all events, and draw the next picture if there is one and it may be drawn."""
        outputs: list[Output] = []
        while self._events:
            try:
                outputs += self._apply(self._events.popleft())
            except InputError as error:
                outputs.append(_trouble(error))
        outputs += self._tell_settings()
        if may_draw and self.live is not None:
            try:
                outputs += self._next_picture(self.live)
            except Superseded:
                pass
            except InputError as error:
                self._level = 3
                outputs.append(_trouble(error))
        return outputs

    @property
    def camera(self) -> Camera | None:
        """The camera, as it is drawn: rounded."""
        return None if self._camera is None else self._camera.rounded()

    def command(self) -> list[str]:
        """Return the arguments of ``splatline`` that make this picture.

        Raises
        ------
        InputError
            If the cloud is not read yet.
        """
        if self.camera is None:
            raise InputError("the cloud is not read yet")
        return render_command(
            self.subject, self._shown_colour, self.camera, self.size, self.settings
        )

    # -- events ---------------------------------------------------------------------------------

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
            return self._save(values["what"])
        elif self._camera is not None and self._home is not None:
            self._move(event, self._camera, self._home)
        return []

    def _move(self, event: Event, camera: Camera, home: Camera) -> None:
        """Move the camera."""
        values, size = event.values, self.size
        if event.kind == "turn":
            a_pixel = 180.0 / min(size)
            camera = camera.turned(-values["dx"] * a_pixel, values["dy"] * a_pixel)
        elif event.kind == "pan":
            camera = camera.panned(values["dx"], values["dy"], size)
        elif event.kind == "zoom":
            least, most = NEAREST * home.distance, FARTHEST * home.distance
            wanted = min(max(camera.distance * values["factor"], least), most)
            camera = camera.zoomed(wanted / camera.distance, (values["x"], values["y"]), size)
        elif event.kind == "orbit":
            camera = dataclasses.replace(
                camera, azimuth=values["azimuth"], elevation=values["elevation"]
            ).turned(0.0, 0.0)
        elif event.kind == "look":
            camera = self._look(values, camera)
        elif event.kind == "reset":
            camera = self._go_home()
        if camera != self._camera:
            self._camera = _kept_near(camera, home)
            self._moved_at, self._level = self._clock(), 0

    def _look(self, values: dict[str, float], camera: Camera) -> Camera:
        """Return the camera that looks at what is shown at a pixel, if it is not background."""
        if self._last is None:
            return camera
        drawing, seen_by = self._last
        width, height = drawing.view.width, drawing.view.height
        at = values["x"] * width / self.size[0], values["y"] * height / self.size[1]
        column, line = int(at[0] // 1), int(at[1] // 1)
        if not (0 <= column < width and 0 <= line < height):
            return camera
        depth = drawing.depth_at(column, line)
        if depth is None:
            return camera
        return camera.looking_at(seen_by.point_at(at, depth, (width, height)))

    def _resize(self, size: tuple[int, int]) -> None:
        """Change the size; a camera that never moved sees the whole cloud again."""
        if size == self.size:
            return
        unmoved = self._camera == self._home
        self.size, self._level = size, 0
        self.pace.forget()
        if self.live is not None:
            camera = self._go_home()
            self._camera = camera if unmoved else self._camera

    def _go_home(self) -> Camera:
        """Fit the first camera to the size and return it; take it if there is none."""
        assert self.live is not None
        self._home = self.subject.home(self.live, self.size)
        self._camera = self._camera or self._home
        return self._home

    def _set(self, name: str, value: Any) -> None:
        """Change a setting."""
        if name in ("show", "split"):
            setattr(self, name, value)
        elif name == "colour":
            check_map(value)
            self.colour = value
            return
        else:
            self.settings = self._changed(name, value)
        if name in ("preset", "quality"):
            self.pace.forget()
        self._level = 0

    def _changed(self, name: str, value: Any) -> Settings:
        """Return the settings with another value."""
        if name != "preset":
            settings = dataclasses.replace(self.settings, **{name: value})
        else:
            preset = PRESETS[value]
            paper = preset.plane and self.settings.quality == "paper"
            quality = "exact" if paper else self.settings.quality
            settings = dataclasses.replace(self.settings, preset=preset, quality=quality)
        check_request(settings.samples, settings.preset, settings.quality, "table", settings.skips)
        return settings

    def _tell_settings(self) -> list[Output]:
        """Return the settings without the camera, if they changed."""
        settings = self.settings
        colour = self.colour
        values: dict[str, Any] = {
            "type": "settings",
            "preset": settings.preset.name,
            "quality": settings.quality,
            "samples": settings.samples,
            "lights": settings.lights,
            "background": hex_colour(settings.background),
            "colour": {"by": DEFAULT_COLOUR, "map": None, "range": None}
            if colour is None
            else {
                "by": colour.field,
                "map": colour.map,
                "range": None if colour.range is None else list(colour.range),
            },
            "show": self.show,
            "split": None
            if self.split is None
            else dict(zip(("left", "right"), self.split, strict=True)),
        }
        if values == self._told:
            return []
        self._told = values
        return [{**values, "camera": self._described_camera()}]

    def _described_camera(self) -> dict[str, Any] | None:
        """Return the camera as plain values."""
        if self.camera is None:
            return None
        return {**dataclasses.asdict(self.camera), "target": list(self.camera.target)}

    # -- pictures -------------------------------------------------------------------------------

    def _next_picture(self, live: LiveCloud) -> list[Output]:
        """Draw the next picture that is due."""
        resting = not self._moving and self._clock() >= self._moved_at + QUIET
        if self._level == 0:
            return self._draw_quick(live, resting)
        if self._level < 3 and resting:
            return self._refine(live)
        return []

    def _draw_quick(self, live: LiveCloud, resting: bool) -> list[Output]:
        """Draw a picture of one sample a pixel, as coarse as it must be to be in time."""
        divisor = self.pace.divisor
        size = tuple(max(side // divisor, 1) for side in self.size)
        start = self._clock()
        drawing = self._drawing(live, (size[0], size[1]), 1)
        rgba = self._rgba(drawing)
        self.pace.took(divisor, self._clock() - start)
        self._level = 2 if divisor == 1 else 1
        return [self._picture(rgba, refined=False)]

    def _refine(self, live: LiveCloud) -> list[Output]:
        """Draw a picture of the full size; the last one has all samples, and its numbers."""
        samples = self.settings.samples if self._level == 2 else 1
        start = self._clock()
        if self._level == 2 and samples == 1 and self._last is not None:
            drawing = self._last[0]
        else:
            drawing = self._drawing(live, self.size, samples, self._check)
        host_ms = 1e3 * (self._clock() - start)
        last = samples == self.settings.samples
        self._level = 3 if last else 2
        outputs: list[Output] = [self._picture(self._rgba(drawing), refined=last)]
        if not last:
            return outputs
        numbers = {
            "type": "numbers",
            "frame": self._frame,
            **picture_numbers(drawing),
            "host_ms": host_ms,
            "golden_ms": 0.0,
            "psnr": None,
        }
        self._told = None
        return [*outputs, numbers, *self._tell_settings()]

    def _drawing(
        self,
        live: LiveCloud,
        size: tuple[int, int],
        samples: int,
        check: Callable[[], None] = lambda: None,
    ) -> Drawing:
        """Draw with the camera and settings as they are."""
        camera = self.camera
        assert camera is not None
        settings = dataclasses.replace(self.settings, samples=samples)
        drawing = draw(live, camera, size, settings, check=check)
        self._last = drawing, camera
        return drawing

    def _check(self) -> None:
        """Raise ``Superseded`` if there is an event that asks for another picture."""
        if any(event.kind not in ANSWERED for event in tuple(self._events)):
            raise Superseded

    def _rgba(self, drawing: Drawing) -> npt.NDArray[np.uint8]:
        """Return the pixels that are shown of a drawing."""
        return drawing.rgba if self.show == "picture" else drawing.depth_rgba

    def _picture(self, rgba: npt.NDArray[np.uint8], *, refined: bool) -> Picture:
        """Return a picture with the next number."""
        self._frame += 1
        return Picture(self._frame, rgba, refined)

    def _save(self, what: str) -> list[Output]:
        """Return the picture, or its code words, as a file."""
        raise InputError("nothing is saved yet")


def _trouble(error: InputError) -> dict[str, Any]:
    """Return an error as a message of one line."""
    return {"type": "error", "text": " ".join(str(error).split())}


def _kept_near(camera: Camera, home: Camera) -> Camera:
    """Return a camera whose target is not lost far from the cloud."""
    reach = FARTHEST * home.distance
    target = tuple(
        min(max(value, middle - reach), middle + reach)
        for value, middle in zip(camera.target, home.target, strict=True)
    )
    return dataclasses.replace(camera, target=target)
