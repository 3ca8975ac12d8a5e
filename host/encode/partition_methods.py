"""The ways of dividing a frame's elements among the engines of a chain."""

from __future__ import annotations

__all__ = ["DEFAULT_METHOD", "METHODS"]

METHODS = {
    "columns": "each line's elements by their columns, cut into strips",
    "elements": "one element after the other, round robin",
    "lines": "whole lines, each to the engine that has the fewest elements so far",
}
"""Names and meanings; ``docs/bench/chain.md`` has their cycles."""

DEFAULT_METHOD = "columns"
