"""Answers of a live view: pictures, files and messages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

__all__ = ["Output", "Picture", "SavedFile", "Superseded", "Tell", "error_message"]

Tell = Callable[[str, float | None], None]
"""Told what is being done, and the share of it that is done; 1 ends it."""


class Superseded(Exception):  # noqa: N818  (it is no error)
    """Work is not needed any more, since something changed."""


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


@dataclass(frozen=True)
class SavedFile:
    """A file for the person: its name, its type, and its bytes."""

    name: str
    mime: str
    data: bytes


Output = dict[str, Any] | Picture | SavedFile
"""A message of the protocol, a picture, or a file."""


def error_message(error: InputError) -> dict[str, Any]:
    """Return an error as a message of one line."""
    return {"type": "error", "text": " ".join(str(error).split())}
