"""Tables of Markdown pages."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

__all__ = ["table"]


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], words: int | Collection[str]) -> str:
    """Return a table: text stands on the left, numbers on the right.

    Parameters
    ----------
    heads
        Of the columns.
    rows
        The cells of each line.
    words
        The columns that are text: their heads, or how many, the first ones.
    """
    text = heads[:words] if isinstance(words, int) else words
    rule = "|".join("---" if head in text else "---:" for head in heads)
    lines = [f"| {' | '.join(cells)} |" for cells in (heads, *rows)]
    return "\n".join([lines[0], f"|{rule}|", *lines[1:]])
