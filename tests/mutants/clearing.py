"""What the clearing after a reset writes: found by simulation with unknown values.

All registers and inputs are unknown, but for the reset. What is known nevertheless holds for all
states and inputs. So the simulation is a proof for every reset.
"""

from .aig import Aig

__all__ = ["Clearing", "bits_of", "clear"]

UNKNOWN = 2
NOT = (1, 0, UNKNOWN)
AND = ((0, 0, 0), (0, 1, UNKNOWN), (0, UNKNOWN, UNKNOWN))


class Clearing:
    """A design while it clears its memories, cycle by cycle.

    Parameters
    ----------
    aig
        The design.
    literals
        What is looked at.
    """

    def __init__(self, aig: Aig, literals: list[int]):
        self.aig = aig
        needed, fresh = set(), {literal & ~1 for literal in literals}
        inputs = {gate: (a & ~1, b & ~1) for gate, a, b in aig.gates}
        while fresh:
            one = fresh.pop()
            needed.add(one)
            behind = {aig.latches[one] & ~1} if one in aig.latches else inputs.get(one, ())
            fresh |= set(behind) - needed
        self.gates = [gate for gate in aig.gates if gate[0] in needed]
        self.latches = {now: value for now, value in aig.latches.items() if now in needed}
        self.values = [UNKNOWN] * (max(needed | {aig.names["rst"]}) + 2)
        self.values[0], self.values[1] = 0, 1

    def set(self, literal: int, value: int) -> None:
        """Set a literal and its inverse."""
        self.values[literal], self.values[literal ^ 1] = value, NOT[value]

    def cycle(self, reset: int) -> None:
        """Advance to the next cycle once the gates have settled, then settle again."""
        values = self.values
        following = {now: values[value] for now, value in self.latches.items()}
        for now, value in following.items():
            self.set(now, value)
        self.settle(reset)

    def settle(self, reset: int) -> None:
        """Give the gates their values."""
        values = self.values
        self.set(self.aig.names["rst"], reset)
        for gate, a, b in self.gates:
            value = AND[values[a]][values[b]]
            values[gate], values[gate ^ 1] = value, NOT[value]


def clear(aig: Aig, memories: list[str], depth: int) -> int | None:
    """Return in how many cycles after a reset all words of some memories are cleared.

    A lane's word is cleared if its depth, the lowest bits, is all 1; a word of dirty bits if it is
    0. None: not all words are, or not surely, or something is written over them.

    Parameters
    ----------
    aig
        The design, with the ports of its memories as outputs.
    memories
        Their names.
    depth
        Bits of a depth.
    """
    ports = {name: _ports(aig, name) for name in memories}
    flags = [aig.names["w.sweeping"], aig.names["w.swept"]]
    written = [bit for own in ports.values() for port in own for part in port for bit in part]
    run = Clearing(aig, [*flags, *written])
    cleared: dict[str, set[int]] = {name: set() for name in memories}
    run.settle(1)
    longest = 2 << max(len(own[0][0]) for own in ports.values())
    for count in range(longest):
        run.cycle(0)
        state = [run.values[flag] for flag in flags]
        if state == [0, 0]:
            whole = all(len(cleared[name]) == 1 << len(ports[name][0][0]) for name in memories)
            return count if whole else None
        if UNKNOWN in state:
            return None
        for name, own in ports.items():
            value = 1 if ".lane_" in name else 0
            bits = depth if value else None
            for port in own:
                address, enable, data = ([run.values[bit] for bit in part] for part in port)
                _write(cleared[name], address, enable, data[:bits], value)
    return None


def _write(cleared: set[int], address: list[int], enable: list[int], data, value: int) -> None:
    """Follow a write in the set of cleared words."""
    if not any(enable):
        return
    if UNKNOWN in address:
        cleared.clear()
        return
    place = sum(bit << n for n, bit in enumerate(address))
    if all(one == 1 for one in enable) and all(bit == value for bit in data):
        cleared.add(place)
    else:
        cleared.discard(place)


def _ports(aig: Aig, memory: str) -> list[tuple[list[int], list[int], list[int]]]:
    """Return the bits of address, enable and data of each port that writes."""
    read, address, enable, data = (
        bits_of(aig, f"{memory}.{name}")
        for name in ("read_address", "write_address", "write_enable", "write_data")
    )
    count = len(address) // len(read)
    wide = len(enable) // count
    return [
        (
            address[n * len(read) : (n + 1) * len(read)],
            enable[n * wide : (n + 1) * wide],
            data[n * wide : (n + 1) * wide],
        )
        for n in range(count)
    ]


def bits_of(aig: Aig, name: str) -> list[int]:
    """Return the literals of a signal's bits, the lowest first."""
    if name in aig.names:
        return [aig.names[name]]
    bits: list[int] = []
    while f"{name}[{len(bits)}]" in aig.names:
        bits.append(aig.names[f"{name}[{len(bits)}]"])
    return bits
