"""The wide gates of :mod:`splatline.rtl.lib.mux` by their former module."""

from .mux import all_of, any_of

__all__ = ["all_of", "any_of"]
