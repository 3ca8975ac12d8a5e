"""And-inverter graphs with latches: read as text from Yosys, written in binary for ABC."""

import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

__all__ = ["Aig", "read_aig"]

SYMBOL = re.compile(r"([ilo])(\d+) (.*)")


@dataclass
class Aig:
    """A graph whose literals are twice a variable's number, plus 1 if inverted.

    Parameters
    ----------
    inputs
        Literals of the inputs.
    latches
        By literal of a latch, that of its next value; all are 0 at first. One that is 1 at first
        is held inverted.
    outputs
        Literals of the outputs.
    gates
        Literals of each gate and of its two inputs; inputs of gates come before them.
    names
        Literals by each of their names: of inputs, latches and outputs.
    """

    inputs: list[int]
    latches: dict[int, int]
    outputs: list[int]
    gates: list[tuple[int, int, int]]
    names: dict[str, int]

    def binary(self) -> bytes:
        """Return the graph in the AIGER format, with new numbers."""
        number = {0: 0}
        for literal in [*self.inputs, *self.latches, *(gate for gate, _, _ in self.gates)]:
            number[literal >> 1] = len(number)

        def new(literal: int) -> int:
            return 2 * number[literal >> 1] + (literal & 1)

        head = [len(number) - 1, *map(len, (self.inputs, self.latches, self.outputs, self.gates))]
        lines = [" ".join(map(str, ["aig", *head]))]
        lines += [str(new(literal)) for literal in [*self.latches.values(), *self.outputs]]
        coded = bytearray()
        for gate, *both in self.gates:
            high, low = sorted(map(new, both), reverse=True)
            for delta in (new(gate) - high, high - low):
                while delta > 127:
                    coded.append(delta & 127 | 128)
                    delta >>= 7
                coded.append(delta)
        return "".join(f"{line}\n" for line in lines).encode() + bytes(coded)


def read_aig(path: Path) -> Aig:
    """Read a graph that Yosys wrote with ``write_aiger -ascii -symbols``."""
    lines = path.read_text().splitlines()
    _, inputs, latches, outputs, gates = map(int, lines[0].split()[1:6])
    ends = [1]
    for count in (inputs, latches, outputs, gates):
        ends.append(ends[-1] + count)
    parts = [[tuple(map(int, line.split())) for line in lines[a:b]] for a, b in pairwise(ends)]
    # A latch that is 1 at first is one that is 0, inverted.
    ones = {now for now, _, *first in parts[1] if first == [1]}

    def zeroed(literal: int) -> int:
        return literal ^ (literal & ~1 in ones)

    literals = {
        "i": [one for (one,) in parts[0]],
        "l": [zeroed(now) for now, *_ in parts[1]],
        "o": [zeroed(one) for (one,) in parts[2]],
    }
    names = {}
    for line in lines[ends[-1] :]:
        if found := SYMBOL.fullmatch(line):
            for name in found[3].split():
                names[name] = literals[found[1]][int(found[2])]
    return Aig(
        literals["i"],
        {now: zeroed(following) ^ (now in ones) for now, following, *_ in parts[1]},
        literals["o"],
        [(gate, zeroed(a), zeroed(b)) for gate, a, b in parts[3]],
        names,
    )
