"""Positions of the samples in a pixel, without imports, so that the command line starts fast."""

__all__ = ["SAMPLES"]

SAMPLES = {
    1: ((0, 0),),
    2: ((4, 4), (-4, -4)),
    4: ((-2, -6), (6, -2), (-6, 2), (2, 6)),
    8: ((1, -3), (-1, 3), (5, 1), (-3, -5), (-5, 5), (-7, -1), (3, 7), (7, -7)),
    16: (
        *((1, 1), (-1, -3), (-3, 2), (4, -1), (-5, -2), (2, 5), (5, 3), (3, -5)),
        *((-2, 6), (0, -7), (-4, -6), (-6, 4), (-8, 0), (7, -4), (6, 7), (-7, -8)),
    ),
}
"""Positions of the samples, in sixteenths of a pixel right and down of its centre: the standard
patterns of Direct3D 11. No two samples share a line or a column, so an edge has as many shades."""
