"""The rows of a code word's block, by docs/contract.md."""


def block_rows(rows, mode):
    """Return the rows of a block that have pixels: up to eight of (row, first, last).

    ``rows``: the four pairs of a code word.
    """
    rows = list(rows)
    if mode == 1:
        return filled(enumerate(rows))
    first, last = rows[3]
    if first >= 4 > last:  # the middle lies in row 3
        middle = 7 + ((first + last) % 2 == 0)
        rows[3] = last, first
        below = [(6 - k, middle - rows[k][1], middle - rows[k][0]) for k in range(3)]
    else:
        first, last = rows[0]
        middle = 8 if first > last and first in (2, 3, 6, 7) else 7
        below = [(7 - k, middle - rows[k][1], middle - rows[k][0]) for k in range(4)]
    upper = [(row, ends) for row, ends in enumerate(rows)]
    return filled(upper + [(row, (first, last)) for row, first, last in below])


def is_shifted(rows, mode):
    """Return whether the lower half of a block begins a column further right."""
    if mode == 1:
        return False
    (first, last), (left, right) = rows[0], rows[3]
    if left >= 4 > right:
        return (left + right) % 2 == 0
    return first > last and first in (2, 3, 6, 7)


def filled(rows):
    return [(row, first, last) for row, (first, last) in rows if first <= last]
