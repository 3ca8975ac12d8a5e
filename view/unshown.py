"""Frames that were sent and are not shown yet."""

from __future__ import annotations

__all__ = ["Unshown"]

MOST_UNSHOWN = 2
"""Frames that may be under way or waiting where they are shown."""


class Unshown:
    """Counts the frames that were sent and are not shown yet.

    A slow link or page has no backlog: a frame is drawn only while few are on their way, so what
    is sent next is the newest.
    """

    def __init__(self) -> None:
        self.sent = self._shown = 0

    def note_sent(self, frame: int) -> None:
        """Note that a frame is sent."""
        self.sent = max(self.sent, frame)

    def note_shown(self, frame: int) -> None:
        """Note that a frame is shown, and so are those before."""
        self._shown = max(self._shown, min(frame, self.sent))

    @property
    def are_few(self) -> bool:
        """Whether one more may be drawn."""
        return self.sent - self._shown < MOST_UNSHOWN
