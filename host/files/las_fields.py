"""The fields of a LAS point: where they are in its bytes, and how they become columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .las_header import LasHeader

__all__ = ["Fields", "Table", "field_names"]

Table = dict[str, npt.NDArray[Any]]

LAYERS = {
    **dict.fromkeys(("X", "Y", "bit_fields"), "XY_RETURNS_CHANNEL"),
    "Z": "Z",
    "raw_classification": "CLASSIFICATION",
    "classification": "CLASSIFICATION",
    "classification_flags": "FLAGS",
    "intensity": "INTENSITY",
    **dict.fromkeys(("scan_angle", "scan_angle_rank"), "SCAN_ANGLE"),
    "user_data": "USER_DATA",
    "point_source_id": "POINT_SOURCE_ID",
    "gps_time": "GPS_TIME",
    **dict.fromkeys(("red", "green", "blue"), "RGB"),
    "nir": "NIR",
    **dict.fromkeys(("wavepacket_index", "wavepacket_offset", "wavepacket_size"), "WAVEPACKET"),
    **dict.fromkeys(("return_point_wave_location", "x_t", "y_t", "z_t"), "WAVEPACKET"),
}
"""laspy's name of the layer in which a column of a point is compressed."""

SIDE_BY_SIDE = (("x", "y", "z"), ("red", "green", "blue"))
"""Fields that share an array, as a cloud has them."""


def field_names(header: LasHeader) -> list[str]:
    """Return the fields of a file's points: x, y, z, then those of its format and extra bytes."""
    from laspy import PointFormat  # not before a LAS file is read

    fields = [name for name in PointFormat(header.form).dimension_names if name not in "XYZ"]
    return ["x", "y", "z", *fields, *(extra.name for extra in header.extras)]


class Fields:
    """Some fields of a file's points.

    Parameters
    ----------
    header
        The file's header.
    names
        The fields, of those that ``field_names`` returns.
    """

    def __init__(self, header: LasHeader, names: Sequence[str]) -> None:
        from laspy import PointFormat
        from laspy.point import dims

        self.names = tuple(names)
        base = PointFormat(header.form).dtype()
        assert base.fields is not None and base.names is not None
        columns = {name: (str(base[name].str), base.fields[name][1]) for name in base.names}
        columns |= {extra.name: (extra.kind, extra.start) for extra in header.extras}
        kinds, starts = zip(*columns.values(), strict=True)
        layout: Any = {"names": list(columns), "formats": kinds, "offsets": starts}
        layout["itemsize"] = header.length
        self.dtype: np.dtype[Any] = np.dtype(layout)
        parts = {name: (name, 0) for name in columns}
        parts |= {axis.lower(): (axis, 0) for axis in "XYZ"}
        for column, fields in dims.COMPOSED_FIELDS[header.form].items():
            parts |= {field.name: (column, field.mask) for field in fields}
        self._parts = {name: parts[name] for name in self.names}
        self._scaled = {
            extra.name: (extra.scale, extra.shift)
            for extra in header.extras
            if (extra.scale, extra.shift) != (1.0, 0.0)
        }
        for axis, name in enumerate("xyz"):
            self._scaled[name] = (float(header.scales[axis]), float(header.offsets[axis]))

    def selection(self) -> Any:
        """Return what lazrs must decompress; it heeds that in formats from 6 on."""
        from laspy import DecompressionSelection

        selection = DecompressionSelection.base()
        for column, _ in self._parts.values():
            selection |= DecompressionSelection[LAYERS.get(column, "ALL_EXTRA_BYTES")]
        return selection.to_lazrs()

    def empty(self, count: int) -> Table:
        """Return arrays for the fields of ``count`` points: shape (count,) each."""
        kinds = {
            name: np.dtype(np.float64) if name in self._scaled else self.dtype[column]
            for name, (column, _) in self._parts.items()
        }
        table: Table = {}
        for group in SIDE_BY_SIDE:
            if all(name in kinds for name in group):
                together = np.empty((count, len(group)), kinds[group[0]])
                table |= {name: together[:, i] for i, name in enumerate(group)}
        return table | {
            name: np.empty(count, kind) for name, kind in kinds.items() if name not in table
        }

    def fill(self, table: Table, start: int, rows: npt.NDArray[Any]) -> None:
        """Write the fields of points of ``dtype`` into arrays, from a row on."""
        for name, (column, mask) in self._parts.items():
            out = table[name][start : start + len(rows)]
            if name in self._scaled:
                scale, shift = self._scaled[name]
                np.multiply(rows[column], scale, out=out)
                out += shift
            elif mask:
                np.right_shift(rows[column] & mask, (mask & -mask).bit_length() - 1, out=out)
            else:
                out[:] = rows[column]

    def table(self, rows: npt.NDArray[Any]) -> Table:
        """Return the fields of points of ``dtype`` in new arrays."""
        table = self.empty(len(rows))
        self.fill(table, 0, rows)
        return table
