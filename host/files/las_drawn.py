"""Selection of the points of a LAS file that are drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .las_fields import Fields
from .las_header import LasHeader
from .wanted import NOISE, WITHHELD

__all__ = ["Drawn"]

NOISE_CLASSES = (7, 18)
"""Classes of low and of high noise."""

FLAGS_SINCE = 1
"""Minor version in which a class got its flags. Before, it means what the maker of a file says."""

LONG_CLASS = 6
"""First point format with a class of 8 bits; class 18 is no noise in those before."""


class Drawn:
    """Leaves out points that are withheld or noise; see ``read_las``.

    Parameters
    ----------
    header
        The file's header.
    fields
        The fields that are wanted.
    keep
        Which of ``wanted.UNDRAWN`` are drawn all the same.

    Attributes
    ----------
    read
        The fields that must be read for that.
    """

    def __init__(self, header: LasHeader, fields: Fields, keep: frozenset[str]) -> None:
        self._flags = None
        self._noise = NOISE_CLASSES[: 1 + (header.form >= LONG_CLASS)]
        self.read = fields
        self._keep = keep
        if header.minor >= FLAGS_SINCE and not keep >= {WITHHELD, NOISE}:
            self._flags = Fields(header, ("withheld", "classification"))
            self.read = Fields(header, (*fields.names, *self._flags.names))

    def split(self, rows: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], dict[str, int]]:
        """Return those of some points that are drawn, and the number of the others, by reason."""
        dropped: dict[str, int] = {}
        if self._flags is None:
            return rows, dropped
        table = self._flags.table(rows)
        withheld = table["withheld"] != 0
        noise = np.isin(table["classification"], self._noise)
        left_out = np.zeros(len(rows), np.bool_)
        for reason, which in ((WITHHELD, withheld), (NOISE, noise)):
            if reason not in self._keep and (found := int(np.count_nonzero(which & ~left_out))):
                dropped[reason] = found
                left_out |= which
        return (rows[~left_out] if dropped else rows), dropped
