"""What holds in two rows of lanes while they run in lockstep: see :mod:`.rows`.

The graph has a register ``age``: the cycles since a reset. A row catches a request a cycle after it
came, and tests it in the next.
"""

from dataclasses import replace

from splatline.rtl.blocks.lane_row import HALVES, row_address_bits

from .aig import Aig
from .clearing import bits_of
from .lockstep import Builder
from .renamed import Renaming
from .tops import Design

__all__ = ["FLUSHES", "WRITES", "row_invariants"]

WRITES, FLUSHES = 3, 6
"""Cycles from the last word that is cleared to the first in which the memories hold the same for
good, and to the first in which a beat of the row may leave."""


def row_invariants(aig: Aig, renaming: Renaming, design: Design) -> tuple[list[int], set[int], Aig]:
    """Return what must stay 0, the registers of the mutant that are apart, and the graph with both.

    A request is caught a cycle after it came, and tested in the next. So all of that holds for the
    cycles after a reset in which what the row has comes from its clearing.
    """
    build, names, apart = Builder(aig), aig.names, set()
    sweep = 1 << row_address_bits(design.config)
    age = bits_of(aig, "gold.age")
    columns = range(design.config.pixels_per_word)
    wrong = [names["trigger"]]

    def between(begin: int, end: int | None) -> int:
        late = build.at_least(age, begin)
        return late if end is None else build.both(late, build.at_least(age, end) ^ 1)

    def always(begin: int, end: int, name: str, value: int | list[int]) -> None:
        """A register of both has a value in some cycles."""
        bits = bits_of(aig, f"gold.row.{name}")
        expected = [value] * len(bits) if isinstance(value, int) else value
        unlike = build.any(*map(build.differ, bits, expected))
        wrong.append(build.both(between(begin, end), unlike))

    def alike(spans: list[tuple[int, int | None]], gold: list[int], gate: list[int]) -> None:
        """Registers are alike in some cycles."""
        apart.update(bit & ~1 for bit in gate)
        within = build.any(*(between(*span) for span in spans))
        wrong.append(build.both(within, build.any(*map(build.differ, gold, gate))))

    def pair(name: str) -> tuple[list[int], list[int]]:
        return bits_of(aig, f"gold.row.{name}"), bits_of(aig, f"gate.row.{name}")

    caught, tested, free = (2, sweep + 2), (3, sweep + 3), sweep + WRITES
    for flag in ("caught_store", "caught_clear"):
        always(*caught, flag, 1)
        always(sweep + 2, free + 1, flag, 0)
    always(sweep + 2, free + 1, "mask", 0)
    always(free, free + 2, "draws", 0)
    for name, value in {"draws": 1, "behind": 0, "depth": 1, "colour": 0}.items():
        always(*tested, name, value)
    always(*tested, "not_even", 0)
    always(*tested, "odd", 1)
    for half in HALVES:
        always(*tested, f"hidden_{half}", 0)
        always(*tested, f"twice_{half}", 1)
        always(*caught, f"caught_addresses_{half}", build.less(age, 2))
        always(*tested, f"addresses_{half}", build.less(age, 3))
    for half in HALVES:
        renames = renaming.memories[0].rpartition(".")[2].startswith(half)
        for name, begin in (("caught_addresses", 1), ("addresses", 2)):
            gold, gate = pair(f"{name}_{half}")
            alike([(begin, None)], _renamed(build, renaming, gold) if renames else gold, gate)
        alike([(4, None)], *pair(f"again_{half}"))
        for name in ("hidden", "twice"):
            alike([(3, None)], *pair(f"{name}_{half}"))
        alike([(free + 2, None)], *pair(f"leaving_{half}"))
        for column in columns:
            alike([(free + 2, None)], *pair(f"old_{half}_{column}"))
            memory = f"row.{half}_{column}.memory.cleared"
            wrong += [names[f"{side}_{memory}"] ^ 1 for side in ("gold", "gate")]
    alike([(free + 1, None)], *_read(aig))
    return wrong, apart, replace(aig, gates=build.gates)


def _renamed(build: Builder, renaming: Renaming, address: list[int]) -> list[int]:
    """Return an address as a mutant has it."""
    control = address[renaming.control]
    inverts = {"inv": 1, "cnot0": control ^ 1, "cnot1": control}[renaming.mode]
    found = list(address)
    found[renaming.bit] = build.differ(found[renaming.bit], inverts)
    return found


def _read(aig: Aig) -> tuple[list[int], list[int]]:
    """Return the registers of what is read from the memories that are compared, of both."""
    own = {bit for name, bit in aig.names.items() if ".memory.gate" in name}
    behind = {gate: (a & ~1, b & ~1) for gate, a, b in aig.gates}

    def reads(literal: int) -> bool:
        fresh, seen = {literal & ~1}, set()
        while fresh:
            seen |= fresh
            fresh = {one for gate in fresh for one in behind.get(gate, ())} - seen
        return bool(seen & own)

    gates = sorted(
        {
            name: literal
            for name, literal in aig.names.items()
            if name.startswith("gate.row.") and literal & ~1 in aig.latches
        }.items()
    )
    found = {}
    for name, literal in gates:
        if literal & ~1 not in found and reads(aig.latches[literal & ~1]):
            found[literal & ~1] = aig.names[f"gold.{name.removeprefix('gate.')}"], literal
    return [gold for gold, _ in found.values()], [gate for _, gate in found.values()]
