"""The Pareto front of points with a cost and a value."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["front"]


def front(costs: Sequence[float], values: Sequence[float]) -> list[int]:
    """Return the points that no other point dominates.

    One point dominates another if its cost is no higher, its value is no lower, and one of the two
    is better. Equal points are all on the front, or none of them is.

    Parameters
    ----------
    costs
        Shape (n,); lower is better.
    values
        Shape (n,); higher is better.

    Returns
    -------
    list of int
        Indices in order of rising cost, and so of rising value.
    """
    members: list[int] = []
    best = float("-inf")
    for i in sorted(range(len(costs)), key=lambda i: (costs[i], -values[i], i)):
        same = members and (costs[i], values[i]) == (costs[members[-1]], values[members[-1]])
        if values[i] > best or same:
            members.append(i)
            best = values[i]
    return members
