"""Tables of Markdown pages."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

__all__ = ["table"]


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], words: int | Collection[str]) -> str:
    """Return a Markdown table, with text aligned left and numbers aligned right.

    Parameters
    ----------
    heads
        Headings of the columns.
    rows
        Cells of each row.
    words
        Columns of text: their headings, or the number of the first columns that are text.
    """
    text = heads[:words] if isinstance(words, int) else words
    rule = "|".join("---" if head in text else "---:" for head in heads)
    lines = [f"| {' | '.join(cells)} |" for cells in (heads, *rows)]
    return "\n".join([lines[0], f"|{rule}|", *lines[1:]])
