"""The ways of dealing a frame's elements to the engines of a chain."""

from __future__ import annotations

__all__ = ["DEFAULT_METHOD", "METHODS"]

METHODS = {
    "columns": "each line's elements by their columns, cut into strips",
    "elements": "one element after the other, round robin",
    "lines": "whole lines, each to the engine that has the fewest elements so far",
}
"""Ways of dealing; what they cost is measured in ``docs/bench/chain.md``."""

DEFAULT_METHOD = "columns"
