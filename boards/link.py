"""The link between a host and a board: words on the board's bus."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

__all__ = ["Link", "LinkError"]


class LinkError(InputError):
    """The board does not answer, or there is none; the message is one line."""


class Link(Protocol):
    """Reads and writes 32-bit words at byte addresses that are multiples of 4."""

    def read(self, address: int, count: int = 1) -> npt.NDArray[np.uint32]:
        """Return words from an address on: shape (count,), uint32.

        Raises
        ------
        LinkError
            If the board does not answer.
        """

    def write(self, address: int, words: npt.NDArray[np.uint32]) -> None:
        """Write words from an address on: shape (n,), uint32."""
