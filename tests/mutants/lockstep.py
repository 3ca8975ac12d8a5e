"""Two designs in lockstep: registers that are never apart are one, and the others stay apart.

From a graph with the registers of both, ``gold.*`` and ``gate.*``, comes a proof by induction: if
nothing is wrong in a cycle, nothing is wrong in the next, whatever the state. What is wrong: an
output differs, a register that both share would differ, or an invariant does not hold. At first
nothing is wrong.
"""

from dataclasses import replace
from pathlib import Path

from .aig import Aig
from .prove import answer_of, run_abc

__all__ = ["Builder", "merged", "stays_right", "step"]

SEARCH = (
    "read_aiger {name}.aig\nstrash\ndc2\ndfraig\nwrite_aiger {name}.left\niprove\n"
    "write_status {name}.status\n"
)
"""ABC's commands for a step of the induction."""


class Builder:
    """Adds gates to a graph."""

    def __init__(self, aig: Aig):
        every = [*aig.inputs, *aig.latches, *(gate for gate, _, _ in aig.gates)]
        self.free = (max(every) | 1) + 1
        self.gates = list(aig.gates)

    def both(self, a: int, b: int) -> int:
        """Return whether both are 1."""
        self.gates.append((self.free, a, b))
        self.free += 2
        return self.free - 2

    def any(self, *literals: int) -> int:
        """Return whether one is 1."""
        none = 1
        for literal in literals:
            none = self.both(none, literal ^ 1)
        return none ^ 1

    def differ(self, a: int, b: int) -> int:
        """Return whether one is 1 and the other is not."""
        return self.any(self.both(a, b ^ 1), self.both(a ^ 1, b))

    def at_least(self, bits: list[int], least: int) -> int:
        """Return whether a number, the lowest bit first, is at least a constant."""
        found = 1
        for n, bit in enumerate(bits):
            found = self.both(bit, found) if least >> n & 1 else self.any(bit, found)
        return found

    def less(self, bits: list[int], other: int) -> list[int]:
        """Return the bits of a number less a constant."""
        found, borrow = [], 0
        for n, bit in enumerate(bits):
            one = other >> n & 1
            found.append(self.differ(bit ^ one, borrow))
            borrow = self.any(bit ^ 1, borrow) if one else self.both(bit ^ 1, borrow)
        return found


def merged(aig: Aig, wrong: list[int], apart: set[int]) -> Aig:
    """Return a graph with the registers of both shared, and one output: something is wrong.

    Parameters
    ----------
    aig
        The graph with both.
    wrong
        Outputs of it that must stay 0.
    apart
        Latches of ``gate`` that are not shared.
    """
    shared = {}
    for name, literal in aig.names.items():
        gold = aig.names.get(f"gold.{name.removeprefix('gate.')}")
        if not name.startswith("gate.") or gold is None or literal & ~1 in apart:
            continue
        # Both are the same at first, or they stay apart. Yosys may have made one of them.
        if literal & ~1 in aig.latches and not (literal ^ gold) & 1 and literal != gold:
            shared[literal & ~1] = gold & ~1

    def one(literal: int) -> int:
        return shared.get(literal & ~1, literal & ~1) ^ (literal & 1)

    gates = [(gate, one(a), one(b)) for gate, a, b in aig.gates]
    builder = Builder(replace(aig, gates=gates))
    following = {latch: one(value) for latch, value in aig.latches.items()}
    found = [one(literal) for literal in wrong]
    for gate, gold in shared.items():
        if following[gate] != following[gold]:
            found.append(builder.differ(following[gate], following[gold]))
    left = {latch: value for latch, value in following.items() if latch not in shared}
    return Aig(aig.inputs, left, [builder.any(*found)], builder.gates, {})


def step(aig: Aig) -> tuple[Aig, Aig]:
    """Return two graphs without registers, each with one output that must not become 1.

    The first: the graph's output in the first cycle. The second: that output in a cycle after one
    in which it was 0, from any state.
    """
    first = _at_zero(aig)
    builder = Builder(aig)
    base = builder.free
    inputs = [*aig.latches, *aig.inputs, *(base + 2 * n for n in range(len(aig.inputs)))]
    again = dict(zip(aig.inputs, inputs[len(aig.latches) + len(aig.inputs) :], strict=True))
    builder.free += 2 * len(aig.inputs)
    again |= {0: 0, **aig.latches}

    def later(literal: int) -> int:
        return again[literal & ~1] ^ (literal & 1)

    for gate, a, b in aig.gates:
        again[gate] = builder.both(later(a), later(b))
    (now,) = aig.outputs
    both = builder.both(now ^ 1, later(now))
    return first, Aig(inputs, {}, [both], builder.gates, {})


def stays_right(folder: Path, aig: Aig) -> bool:
    """Return whether a graph's output is shown to stay 0; ``folder`` is for ABC's files."""
    graphs = step(aig)
    for number, graph in enumerate(graphs):
        (folder / f"{number}.aig").write_bytes(graph.binary())
    run_abc(folder, "".join(SEARCH.format(name=number) for number in range(len(graphs))))
    return all(answer_of(folder, number) == "equal" for number in range(len(graphs)))


def _at_zero(aig: Aig) -> Aig:
    """Return the graph with all latches 0."""

    def value(literal: int) -> int:
        return literal & 1 if literal & ~1 in aig.latches else literal

    gates = [(gate, value(a), value(b)) for gate, a, b in aig.gates]
    return Aig(aig.inputs, {}, [value(literal) for literal in aig.outputs], gates, {})
