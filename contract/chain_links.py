"""How a chain's engines are joined: names and limits, which the command line asks for as well."""

__all__ = ["LINKS", "MOST_ENGINES"]

LINKS = ("merge", "load")
"""How an engine's picture goes on to the next: joined on the way out, or loaded into its window."""

MOST_ENGINES = 64
