"""Coarseness of pictures, so that each is drawn within the display's period."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["BUDGET", "Pace", "ladder"]

BUDGET = 0.028
"""Seconds that a picture may take while the camera moves: 30 a second, with some time to send it.
"""

COARSEST = 8.0
"""Largest divisor of a picture's sides."""

ROOM = 0.9
"""Share of the budget that a finer picture must be expected to stay within, lest finer and coarser
ones take turns."""

TOO_LONG = 2.0
"""A picture of this many budgets is followed by a coarser one at once; else the second is."""

AGED = 0.97
"""Factor of a finer picture's time after each coarser one, so that it is tried again some time."""


def ladder(size: tuple[int, int], most: tuple[int, int]) -> list[float]:
    """Return the divisors of a picture's sides, the finest first.

    Parameters
    ----------
    size
        Width and height of the picture in pixels.
    most
        Those that the engine draws at once: a larger picture is drawn in tiles, so the largest
        without tiles is a step.
    """
    steps = {1.0, 2.0, 4.0, COARSEST}
    steps.add(min(max(size[0] / most[0], size[1] / most[1], 1.0), COARSEST))
    return sorted(steps)


class Pace:
    """Chooses the divisor of a moving picture's sides from the times that pictures took.

    Parameters
    ----------
    steps
        Divisors, from 1 on: see :func:`ladder`.
    budget
        Seconds that a picture may take.
    """

    def __init__(self, steps: Sequence[float] = (1.0, 2.0, 4.0, 8.0), budget: float = BUDGET):
        self.budget = budget
        self._steps = list(steps)
        self._step = 0
        self._seconds: dict[int, float] = {}
        self._late = False

    @property
    def divisor(self) -> float:
        """The divisor of the next picture."""
        return self._steps[self._step]

    def took(self, seconds: float) -> None:
        """Note the time of a picture with the present divisor, and choose the next one's.

        After two pictures that took too long, or one of twice the budget, the next is coarser. A
        finer one is tried when it is expected to be in time: it takes at most as many times as long
        as it has pixels, and about as long as it took before.
        """
        step = self._step
        self._seconds[step] = seconds
        if seconds > self.budget:
            if (self._late or seconds > TOO_LONG * self.budget) and step + 1 < len(self._steps):
                self._step, self._late = step + 1, False
            else:
                self._late = True
            return
        self._late = False
        if not step:
            return
        most = seconds * (self._steps[step] / self._steps[step - 1]) ** 2
        before = self._seconds.get(step - 1, most)
        self._seconds[step - 1] = AGED * min(before, most)
        if self._seconds[step - 1] <= ROOM * self.budget:
            self._step = step - 1

    def took_full(self, seconds: float) -> None:
        """Note the time of a picture of the full size that was drawn at rest."""
        self._seconds[0] = seconds
        if seconds <= ROOM * self.budget:
            self._step = 0
