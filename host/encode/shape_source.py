"""The shape sources of :mod:`splatline.host.encode.quality` by their former module."""

from .quality import SHAPE_SOURCES, check_shapes

__all__ = ["SHAPE_SOURCES", "check_shapes"]
