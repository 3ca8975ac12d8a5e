"""A person's look at a cloud: events in, pictures and answers out. There is no network in it."""

from __future__ import annotations

import dataclasses
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy

from .camera import Camera
from .choices import Choices
from .command_line import render_command, shell_text
from .easel import Easel, Sight
from .events import Event
from .live_cloud import LiveCloud
from .outputs import Output, SavedFile, Superseded, Tell, error_message
from .pace import Pace
from .saved import saved_picture, saved_words
from .steering import steer
from .subject import Subject

__all__ = ["Session"]

QUIET = 0.15
"""Seconds after the last step of the camera before a picture is refined."""

ANSWERED = ("save", "command")
"""Kinds of events that change no picture."""


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
        self._clock = clock
        self._easel = Easel(pace, clock, self._check, tell, between)
        self._events: deque[Event] = deque()
        self._colour = self.choices.colour  # of the cloud
        self._camera: Camera | None = None
        self._home: Camera | None = None
        self._moving = False
        self._moved_at = -QUIET
        self._drawn: Sight | None = None  # while it is drawn
        self._told: dict[str, Any] | None = None

    def call(self, tell: Tell, between: Callable[[], None]) -> None:
        """Call these within long work; see the class."""
        self._easel.tell, self._easel.between = tell, between

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
        self._easel.change()

    def refuse(self, colour: ColourBy | None) -> None:
        """Keep the colours as they are, since the cloud has no such ones."""
        if colour == self.choices.colour:
            self.choices = dataclasses.replace(self.choices, colour=self._colour)
            self._told = None

    def due(self, *, may_draw: bool = True) -> float | None:
        """Return the seconds until there is something to do; None: only an event brings some."""
        if self._events:
            return 0.0
        if not may_draw:
            return None
        if self._told is None:
            return 0.0
        if self.live is None or self._easel.is_done(self.choices):
            return None
        if self._easel.is_blank:
            return 0.0
        return None if self._moving else max(self._moved_at + QUIET - self._clock(), 0.0)

    def work(self, *, may_draw: bool = True) -> list[Output]:
        """Apply all events; draw the next picture, if one is due and may be drawn."""
        outputs: list[Output] = []
        while self._events:
            try:
                outputs += self._apply(self._events.popleft())
            except InputError as error:
                outputs.append(error_message(error))
        outputs += self._tell_settings()
        if may_draw:
            outputs += self._draw()
        return outputs

    def _draw(self) -> list[Output]:
        """Draw the next picture that is due; a refined one is followed by the settings."""
        self._drawn = sight = self._sight
        if sight is None:
            return []
        resting = not self._moving and self._clock() >= self._moved_at + QUIET
        try:
            outputs = self._easel.draw(sight, resting=resting)
        except Superseded:
            return []
        except InputError as error:
            self._easel.give_up()
            return [error_message(error)]
        if any(isinstance(output, dict) for output in outputs):
            self._told = None
        return [*outputs, *self._tell_settings()]

    @property
    def _sight(self) -> Sight | None:
        """What is to be drawn; None before the cloud is read."""
        if self.live is None or self.camera is None:
            return None
        return Sight(self.live, self.camera, self.choices, self.size)

    def _check(self) -> None:
        """Raise ``Superseded`` if another picture is asked for, or none."""
        if self.closed or self._drawn != self._sight:
            raise Superseded
        if any(event.kind not in ANSWERED for event in tuple(self._events)):
            raise Superseded

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
            camera = steer(event, self._camera, self._home, self.size, self._easel.seen)
            if camera != self._camera:
                self._camera, self._moved_at = camera, self._clock()
                self._easel.change()
        return []

    def _set(self, name: str, value: Any) -> None:
        """Make a choice; other colours are shown when the cloud is read in them."""
        self.choices = self.choices.changed(name, value)
        if name in ("preset", "quality"):
            self._easel.start_pace(self.size, self.choices.settings.preset)
        if name != "colour":
            self._easel.change()

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
            self._easel.change()

    def _fit(self, live: LiveCloud) -> None:
        """Fit the first camera to the size, and take it if there is none."""
        self._home = self.subject.home(live, self.size)
        self._camera = self._camera or self._home
        self._easel.start_pace(self.size, self.choices.settings.preset)

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

    def _save(self, what: str) -> SavedFile:
        """Return the refined picture, or its code words, as a file."""
        sight = self._sight
        if sight is None:
            raise InputError("the cloud is not read yet")
        drawing, name = self._easel.drawing(sight), self.subject.name
        if what == "words":
            return saved_words(drawing, name)
        return saved_picture(drawing, name, self.choices.show)
