"""The Pareto front: what nothing else beats in both cost and value."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["front"]


def front(costs: Sequence[float], values: Sequence[float]) -> list[int]:
    """Return which points no other point dominates.

    One point dominates another if it costs no more and is worth no less, and is better in one of
    the two. Of equal points all are on the front.

    Parameters
    ----------
    costs
        Shape (n,): less is better.
    values
        Shape (n,): more is better.

    Returns
    -------
    list of int
        Indices, by rising cost (and so by rising value).
    """
    members: list[int] = []
    best = float("-inf")
    for i in sorted(range(len(costs)), key=lambda i: (costs[i], -values[i], i)):
        same = members and (costs[i], values[i]) == (costs[members[-1]], values[members[-1]])
        if values[i] > best or same:
            members.append(i)
            best = values[i]
    return members
