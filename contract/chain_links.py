"""The links of a chain: names and limits."""

__all__ = ["LINKS", "MOST_ENGINES"]

LINKS = ("merge", "load")
"""Ways of an engine's picture to the next: by a merger, or loaded into the window."""

MOST_ENGINES = 64
