"""How coarse a picture must be, so that it is drawn within the display's period."""

from __future__ import annotations

__all__ = ["BUDGET", "COARSEST", "Pace"]

BUDGET = 0.025
"""Seconds that a picture may take while the camera moves."""

COARSEST = 8
"""Largest divisor of a picture's sides."""

ROOM = 0.7
"""Share of the budget that a finer picture must be expected to stay within, lest it be tried and
given up in turn."""


class Pace:
    """Chooses the divisor of a moving picture's sides from the times that pictures took.

    Parameters
    ----------
    budget
        Seconds that a picture may take.
    """

    def __init__(self, budget: float = BUDGET) -> None:
        self.budget = budget
        self.divisor = 1
        self._seconds: dict[int, float] = {}

    def took(self, divisor: int, seconds: float) -> None:
        """Note the time of a picture, and choose the divisor of the next one.

        A picture that took too long is followed by one of half the side. A finer one is tried when
        its time, at most four times that of this picture, fits the budget; or when it fitted the
        last time that it was drawn, in the same proportion to this picture.
        """
        before = self._seconds.get(divisor, seconds)
        self._seconds[divisor] = seconds
        if divisor != self.divisor:
            if divisor < self.divisor and seconds <= ROOM * self.budget:
                self.divisor = divisor
            return
        if seconds > self.budget:
            self.divisor = min(2 * divisor, COARSEST)
            return
        finer = divisor // 2
        if not finer:
            return
        expected = 4.0 * seconds
        if finer in self._seconds:
            # Times change with the view: that of the finer picture in proportion to this one's.
            self._seconds[finer] *= seconds / before
            expected = min(expected, self._seconds[finer])
        if expected <= ROOM * self.budget:
            self.divisor = finer

    def forget(self) -> None:
        """Start anew, as after a change of size or engine."""
        self.divisor = 1
        self._seconds.clear()
